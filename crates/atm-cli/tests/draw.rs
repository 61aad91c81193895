//! `atm draw`: what goes into a picture, and what is said where none can be made.
#![cfg(feature = "lab")]

mod support;

use std::fs;

use support::*;

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The sample's echoes, and its crossings.
fn fused(scratch: &Scratch) -> (String, String) {
    let (echoes, crossings) = (scratch.name("echoes.csv"), scratch.name("crossings.csv"));
    fuse_sample(&["-o", &echoes, "--crossings", &crossings, "-q"]).exits(0);
    (echoes, crossings)
}

fn draw(args: &[&str]) -> Ran {
    atm(["draw"].iter().chain(args))
}

/// The SVG that these arguments give.
#[track_caller]
fn svg(args: &[&str]) -> String {
    draw(&[args, &["-o", "-"]].concat()).exits(0).text().to_owned()
}

/// How often the pen is set down in the first path of a class, which is not the legend's.
fn shapes(svg: &str, class: &str) -> usize {
    let found = svg.lines().find(|line| line.starts_with(&format!("<path class=\"{class}\"")));
    found.map_or(0, |line| line.matches('M').count())
}

/// Width and height in the header of a PNG.
fn png_size(bytes: &[u8]) -> (u32, u32) {
    assert!(bytes.starts_with(PNG), "no PNG");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    (number(16), number(20))
}

#[test]
fn every_echo_of_the_sample_is_drawn_by_its_kind() {
    let scratch = Scratch::new();
    let (table, _) = fused(&scratch);
    let echoes = echoes(&read(&table));
    let drawn = svg(&[&table, "--zoom", "-20m,-20m,20m,20m"]);
    for kind in ["median", "single", "center"] {
        let expected = count(&echoes, kind);
        assert!(expected > 0, "no {kind} in the sample");
        assert_eq!(shapes(&drawn, kind), expected, "{kind}");
    }
}

#[test]
fn a_log_gives_its_path_and_an_arc_for_each_echo() {
    let arcs = sample_rows().iter().filter(|row| row.echo().is_some()).count();
    let drawn = svg(&[SAMPLE, "--rig", "nomad200", "--zoom", "-20,-20,20,20"]);
    assert_eq!(shapes(&drawn, "faint"), arcs);
    assert_eq!(shapes(&drawn, "path"), 1);
    // Beside echoes, arcs are drawn where they are asked for.
    let scratch = Scratch::new();
    let (table, _) = fused(&scratch);
    let both = [SAMPLE, "--rig", "nomad200", &table];
    assert_eq!(shapes(&svg(&both), "faint"), 0);
    assert_eq!(shapes(&svg(&both), "path"), 1);
    assert!(shapes(&svg(&[&both[..], &["--only", "arcs"]].concat()), "faint") > 0);
}

#[test]
fn only_takes_kinds_and_layers() {
    let scratch = Scratch::new();
    let (table, crossings) = fused(&scratch);
    let inputs = [SAMPLE, "--rig", "nomad200", table.as_str(), crossings.as_str(), "--only"];
    let shown = |only: &str| {
        let drawn = svg(&[&inputs[..], &[only]].concat());
        ["median", "single", "center", "crossings", "path", "faint"].map(|class| shapes(&drawn, class) > 0)
    };
    assert_eq!(shown("median,single"), [true, true, false, false, true, false]);
    assert_eq!(shown("crossings,path"), [false, false, false, true, true, false]);
    assert_eq!(shown("median,arcs"), [true, false, false, false, false, true]);
    draw(&[&inputs[..], &["medians", "-o", "-"]].concat()).exits(2).says(&["medians", "median"]).writes_nothing();
}

#[test]
fn the_reading_that_is_shown_has_its_beam_its_partners_and_two_rings() {
    let scratch = Scratch::new();
    let (table, crossings) = fused(&scratch);
    let partners = read(&crossings).lines().filter(|line| line.starts_with("20.0,3,")).count();
    assert!(partners > 2, "the case is empty");
    let drawn =
        svg(&[SAMPLE, &table, &crossings, "--rig", "nomad200", "--reading", "20,3", "--only", "beam,partners,median"]);
    assert_eq!(shapes(&drawn, "beam"), 1);
    assert_eq!(shapes(&drawn, "ring"), 1);
    let drawn_partners = shapes(&drawn, "partners");
    assert!(drawn_partners > 0 && drawn_partners <= partners, "{drawn_partners} of {partners}");
}

#[test]
fn panels_choose_from_what_there_is() {
    let scratch = Scratch::new();
    let (table, _) = fused(&scratch);
    let drawn = svg(&[
        SAMPLE,
        &table,
        "--rig",
        "nomad200",
        "--panel",
        &format!("Cones|straight ahead={SAMPLE},centerline"),
        "--panel",
        "Medians=median",
        "--title",
        "Two & two",
    ]);
    for words in ["Cones", "straight ahead", "Medians", "Two &amp; two", "centre of the cone"] {
        assert!(drawn.contains(&format!(">{words}<")), "no {words}");
    }
    assert_eq!(drawn.matches("clipPath id").count(), 2);
    assert!(!drawn.contains("\"single\""));
    draw(&[&table, "--panel", "no names", "-o", "-"]).exits(2);
    draw(&[&table, "--panel", "a=median", "--only", "median", "-o", "-"]).exits(2);
}

#[test]
fn png_has_the_size_that_was_asked_for() {
    let scratch = Scratch::new();
    let (table, _) = fused(&scratch);
    for (more, size) in [(&["--size", "640x480"][..], (640, 480)), (&["--size", "300x200", "--scale", "2"], (600, 400))]
    {
        let picture = scratch.name("picture.PNG");
        draw(&[&[table.as_str(), "-o", &picture], more].concat()).exits(0).writes_nothing();
        assert_eq!(png_size(&fs::read(&picture).expect("a picture")), size);
    }
}

#[test]
fn the_same_inputs_give_the_same_bytes() {
    let scratch = Scratch::new();
    let (table, crossings) = fused(&scratch);
    let args = [SAMPLE, &table, &crossings, "--rig", "nomad200"];
    assert_eq!(svg(&args), svg(&args));
}

#[test]
fn nothing_one_point_and_far_points_can_be_drawn() {
    let scratch = Scratch::new();
    let drawn = |text: &str| svg(&[&scratch.file("points.csv", text)]);
    assert!(drawn(&format!("{HEADER}\n")).contains("nothing to draw"));
    assert_eq!(shapes(&drawn("x,y\n1.5,2\n"), "o0"), 1);
    assert_eq!(shapes(&drawn("x,y\n1e12,-1e12\n1000000000003,-1e12\n"), "o0"), 2);
    assert!(drawn("x,y\n1e300,0\n-1e300,0\n").contains("2 marks lie outside"));
}

#[test]
fn rows_that_cannot_be_used_are_named_and_the_rest_is_drawn() {
    let ran = atm_fed(["draw", "-", "-o", "-"], "x,y,kind\nnan,1,median\n2,3,median\n").exits(3);
    assert_eq!(shapes(ran.text(), "median"), 1);
    ran.says(&["standard input:2", "bad_number", "x \"nan\""]);
}

#[test]
fn what_can_not_be_drawn_is_refused_by_its_name() {
    let scratch = Scratch::new();
    let (table, _) = fused(&scratch);
    draw(&["-o", "-"]).exits(2);
    draw(&[&table]).exits(2);
    draw(&[&table, "-o", &scratch.name("picture.jpg")]).exits(2).says(&["picture.jpg", ".svg or .png"]);
    draw(&["/no/such.csv", "-o", "-"]).exits(1).says(&["/no/such.csv"]);
    draw(&[SAMPLE, "-o", "-"]).exits(2).says(&[SAMPLE, "--rig"]);
    draw(&[&scratch.file("empty.csv", ""), "-o", "-"]).exits(1).says(&["empty.csv", "is empty"]);
    draw(&["-", "-", "-o", "-"]).exits(2).says(&["standard input"]);
    let own = scratch.file("own.svg", read(&table));
    draw(&[&own, "-o", &own]).exits(2).says(&["overwrite"]);
    assert_eq!(read(&own), read(&table));
    for bad in ["1,2", "0,0,0,1", "0,0,-1", "0,0,1parsec", "1e300,0,1,1", ""] {
        draw(&[&table, "-o", "-", "--zoom", bad]).exits(2).writes_nothing();
    }
    for bad in ["0", "63", "900x", "900x600x2", "20000", "-5", "1e3"] {
        draw(&[&table, "-o", "-", &format!("--size={bad}")]).exits(2).writes_nothing();
    }
    draw(&[&table, "-o", "-", "--reading", "soon,3"]).exits(2);
    draw(&[&table, "-o", "-", "--set", "opening=30in"]).exits(2);
    draw(&[&table, "-o", &scratch.name("p.png"), "--size", "16384x16384"]).exits(2).says(&["16384 x 16384"]);
    assert_eq!(scratch.list(), ["crossings.csv", "echoes.csv", "empty.csv", "own.svg"]);
}

/// What the README shows, as docs/eval-and-draw.md says it is made; there, `-o` names the file.
#[test]
fn the_picture_of_the_readme_is_what_its_command_draws() {
    let scratch = Scratch::new();
    let (table, crossings) = fused(&scratch);
    let documents = read(root().join("docs/eval-and-draw.md").to_str().expect("a path in UTF-8"));
    let (_, command) = documents.split_once("$ atm draw examples/doorway.csv").expect("the command of the picture");
    let (command, _) = command.split_once("```").expect("its end");
    // Words between quotes are one argument each.
    let parts = command.split('\'').enumerate().flat_map(|(index, part)| match index % 2 {
        0 => part.replace("\\\n", " ").split_whitespace().map(str::to_owned).collect(),
        _ => vec![part.to_owned()],
    });
    let args: Vec<String> = ["draw", SAMPLE].into_iter().map(str::to_owned).chain(parts).collect();
    let args = args.iter().map(|arg| match arg.as_str() {
        "echoes.csv" => table.as_str(),
        "crossings.csv" => crossings.as_str(),
        "docs/doorway.svg" => "-",
        arg => arg,
    });
    let drawn = atm(args).exits(0);
    let shown = read(root().join("docs/doorway.svg").to_str().expect("a path in UTF-8"));
    assert_same(&drawn.stdout, shown.as_bytes());
}
