use super::*;

/// A directory of its own, and the path of `out.csv` in it.
fn place() -> (tempfile::TempDir, String) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("out.csv").to_str().unwrap().to_owned();
    (directory, path)
}

fn message(path: &str) -> String {
    Output::create(path).err().unwrap().to_string()
}

#[test]
fn the_file_appears_with_the_commit() {
    let (_directory, path) = place();
    let mut output = Output::create(&path).unwrap();
    let partial = output.partial_path().unwrap().to_owned();
    assert_eq!(partial.to_str().unwrap(), format!("{path}.partial"));
    output.write_all(b"t,x\n").unwrap();
    output.flush().unwrap();
    assert_eq!(fs::read(&partial).unwrap(), b"t,x\n");
    assert!(!Path::new(&path).exists());
    output.write_all(b"1,2\n").unwrap();
    output.commit().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"t,x\n1,2\n");
    assert!(!partial.exists());
}

#[test]
fn without_commit_the_old_file_stays_and_the_partial_one_too() {
    let (_directory, path) = place();
    fs::write(&path, "old").unwrap();
    let mut output = Output::create(&path).unwrap();
    output.write_all(b"new").unwrap();
    let partial = output.partial_path().unwrap().to_owned();
    drop(output);
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(fs::read(&partial).unwrap(), b"new");
    // The next run begins afresh.
    let mut output = Output::create(&path).unwrap();
    output.write_all(b"2").unwrap();
    output.commit().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"2");
}

#[test]
fn a_second_run_on_the_same_output_is_refused_and_harms_nothing() {
    let (_directory, path) = place();
    let mut first = Output::create(&path).unwrap();
    first.write_all(b"first").unwrap();
    first.flush().unwrap();
    assert!(message(&path).contains("another run is writing this output"));
    first.write_all(b" run").unwrap();
    first.commit().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"first run");
    Output::create(&path).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"first run");
}

#[test]
fn what_can_not_be_written_is_named() {
    let (directory, path) = place();
    let inside = directory.path().to_str().unwrap();
    assert_eq!(message(inside), format!("{inside}: is a directory, not a file"));
    let nowhere = format!("{inside}/no/out.csv");
    assert_eq!(message(&nowhere), format!("{nowhere}: the directory {inside}/no does not exist"));
    let slash = format!("{inside}/new/");
    assert_eq!(message(&slash), format!("{slash}: is the name of a directory, not of a file"));
    fs::write(&path, "").unwrap();
    assert!(message(&format!("{path}/below")).starts_with(&format!("{path}/below: ")));
    assert!(Output::create("").is_err());
}

#[test]
fn a_read_only_file_is_not_replaced() {
    let (_directory, path) = place();
    fs::write(&path, "kept").unwrap();
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).unwrap();
    assert!(message(&path).contains("read-only"));
    assert_eq!(fs::read(&path).unwrap(), b"kept");
}

#[test]
fn something_else_in_the_place_of_the_partial_file_is_left_alone() {
    let (_directory, path) = place();
    fs::create_dir(format!("{path}.partial")).unwrap();
    assert!(message(&path).contains("is in the way"));
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    #[test]
    fn devices_are_written_directly() {
        let mut null = Output::create("/dev/null").unwrap();
        assert_eq!(null.partial_path(), None);
        null.write_all(b"gone").unwrap();
        null.commit().unwrap();
        let mut full = Output::create("/dev/full").unwrap();
        full.write_all(b"no room").unwrap();
        let Err(Error::Io { file, source }) = full.commit() else { panic!("was written") };
        assert_eq!((&*file, source.kind()), ("/dev/full", io::ErrorKind::StorageFull));
    }

    #[test]
    fn a_link_stays_and_what_it_leads_to_is_replaced() {
        let (directory, path) = place();
        let real = directory.path().join("real.csv");
        fs::write(&real, "old").unwrap();
        symlink(&real, &path).unwrap();
        let mut output = Output::create(&path).unwrap();
        output.write_all(b"new").unwrap();
        output.commit().unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert!(fs::symlink_metadata(&path).unwrap().is_symlink());
    }

    #[test]
    fn a_partial_file_that_is_a_link_is_not_followed() {
        let (directory, path) = place();
        let precious = directory.path().join("precious");
        fs::write(&precious, "kept").unwrap();
        symlink(&precious, format!("{path}.partial")).unwrap();
        assert!(message(&path).contains("is in the way"));
        assert_eq!(fs::read(&precious).unwrap(), b"kept");
    }

    #[test]
    fn a_replaced_file_keeps_its_permissions() {
        let (_directory, path) = place();
        fs::write(&path, "").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).unwrap();
        Output::create(&path).unwrap().commit().unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
    }

    #[test]
    fn links_lead_to_the_same_file() {
        let (directory, path) = place();
        fs::write(&path, "").unwrap();
        let [soft, hard] = ["soft", "hard"].map(|name| directory.path().join(name).to_str().unwrap().to_owned());
        symlink(&path, &soft).unwrap();
        fs::hard_link(&path, &hard).unwrap();
        assert!(same_file(&path, &soft) && same_file(&hard, &path));
        assert!(!same_file("/dev/null", "/dev/null"));
    }
}

#[test]
fn standard_output_has_no_partial_file() {
    let output = Output::create("-").unwrap();
    assert_eq!((output.partial_path(), &**output.name()), (None, "standard output"));
}

#[test]
fn the_same_file_is_recognised_by_any_path() {
    let (directory, path) = place();
    fs::write(&path, "").unwrap();
    let other = format!("{}/./out.csv", directory.path().display());
    assert!(same_file(&path, &other) && overwrites(&path, &other));
    assert!(!same_file(&path, "-") && !overwrites("-", "-"));
    assert!(!same_file(&path, &format!("{path}.missing")));
}

#[test]
fn an_input_that_is_the_outputs_partial_file_would_be_destroyed() {
    let (_directory, path) = place();
    let partial = format!("{path}.partial");
    fs::write(&partial, "half a run").unwrap();
    assert!(overwrites(&path, &partial));
    assert!(!same_file(&path, &partial));
}
