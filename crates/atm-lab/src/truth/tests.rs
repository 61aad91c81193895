use super::*;

fn read(text: &str) -> Result<Truth> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), text).unwrap();
    Truth::read(file.path().to_str().unwrap())
}

#[test]
fn what_is_written_is_read_back_bit_by_bit() {
    let points = [
        (0, "0", TruthPoint { position: Point2::new(0.1, -2.5e-7), azimuth: 1.0 / 3.0, cause: Cause::Corner }),
        (1_500_000_000, "left, low", TruthPoint { position: Point2::new(0.0, 7.0), azimuth: 0.0, cause: Cause::Pole }),
    ];
    let mut writer = TruthWriter::new(Vec::new()).unwrap();
    for (t, sensor, point) in &points {
        writer.write(*t, sensor, point).unwrap();
    }
    let text = String::from_utf8(writer.into_inner()).unwrap();
    assert!(text.starts_with("t,sensor,x,y,azimuth,cause\n0.0,0,0.1,-2.5e-7,"), "{text}");
    let truth = read(&text).unwrap();
    assert_eq!(truth.len(), 2);
    for (t, sensor, point) in &points {
        assert_eq!(truth.get(*t, sensor), Some(point));
    }
    assert_eq!(truth.get(0, "1"), None);
    assert_eq!(truth.get(1, "0"), None);
}

#[test]
fn rows_that_cannot_be_used_are_named() {
    let said = |rows: &str| read(&format!("t,sensor,x,y,azimuth,cause\n{rows}")).unwrap_err().to_string();
    assert!(said("0,0,0,0,0,wall\n1,0,nan,0,0,wall\n").contains(":3: bad_number: x \"nan\""));
    assert!(said("0,0,0,0,0,ghost\n").contains(":2: unknown_cause: cause \"ghost\""));
    assert!(said("0,0,0\n").contains(":2: missing_field"));
    let said = read("t,sensor,x,y\n").unwrap_err().to_string();
    assert!(said.contains("no column azimuth, cause; the columns are: t, sensor, x, y"), "{said}");
}
