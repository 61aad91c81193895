use std::f64::consts::PI;

use super::*;

const RING: &str = "[ring]\ncount = 16\nradius = 0.2\n";

fn parse(text: &str) -> Result<Rig> {
    Rig::parse(text, "r.toml")
}

fn said(text: &str) -> String {
    parse(text).err().map(|error| error.to_string()).unwrap_or_default()
}

/// What a rig with these lines under `[log]` says of its tables.
fn log(lines: &str) -> Result<LogFormats> {
    parse(&format!("{RING}[log]\n{lines}")).map(|rig| rig.log().cloned().unwrap_or_default())
}

/// The same, where it is refused; the first of `lines` is line 5.
fn log_said(lines: &str) -> String {
    log(lines).err().map(|error| error.to_string()).unwrap_or_default()
}

#[test]
fn sensors_one_by_one_inherit_and_override() {
    let rig = parse(
        r#"
        name = "two"
        field_of_view = "30deg"
        min_range = 0.1
        max_range = "4m"
        [[sensor]]
        id = "left"
        x = "0.10m"
        y = "5cm"
        yaw = "90deg"
        topic = "/range/left"
        [[sensor]]
        id = "front"
        field_of_view = "0.5rad"
        min_range = 0
        max_range = "100in"
        range_resolution = "1in"
        "#,
    )
    .unwrap();
    let [left, front] = rig.sensors() else { panic!("{rig:?}") };
    assert_eq!(rig.name(), "two");
    assert_eq!((left.id(), left.topic()), ("left", Some("/range/left")));
    assert_eq!((left.mount().translation.x, left.mount().translation.y), (0.1, 0.05));
    assert_eq!(left.mount().rotation.im, 1.0);
    assert_eq!(left.field_of_view(), Some(30.0 * (PI / 180.0)));
    assert_eq!((left.min_range(), left.max_range(), left.range_resolution()), (0.1, 4.0, None));
    assert_eq!((front.id(), front.topic()), ("front", None));
    assert_eq!(front.mount(), Isometry2::identity());
    assert_eq!(front.field_of_view(), Some(0.5));
    assert_eq!((front.min_range(), front.max_range(), front.range_resolution()), (0.0, 2.54, Some(0.0254)));
    assert_eq!(rig.index_of("front"), Some(1));
}

#[test]
fn what_is_left_out_has_its_default() {
    let rig = parse(RING).unwrap();
    assert_eq!(rig.name(), "r");
    assert_eq!(rig.sensors()[3].ranging(), Ranging::default());
    assert_eq!(rig.sensors()[0].mount().translation.x, 0.2);
    assert_eq!(rig.log(), None);
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_are_read() {
    let text = format!("\u{feff}{}", RING.replace('\n', "\r\n"));
    assert_eq!(parse(&text).unwrap().sensors().len(), 16);
    assert_eq!(
        said("\u{feff}# one\r\n[ring]\r\ncount = 0\r\nradius = 0\r\n"),
        "r.toml:3: `ring.count` = 0: must be 1 to 65535"
    );
}

#[test]
fn a_rig_has_either_a_ring_or_sensors() {
    let neither = "r.toml: no sensors: expected a [ring] or at least one [[sensor]]";
    assert_eq!(said(""), neither);
    assert_eq!(said("name = \"x\""), neither);
    let both = format!("{RING}[[sensor]]\nid = \"a\"\n");
    assert!(said(&both).starts_with("r.toml:4: `sensor`"), "{}", said(&both));
    assert!(said(&both).ends_with("a rig has either [ring] or [[sensor]], not both"));
    assert_eq!(
        said("[sensor]\nid = \"a\""),
        "r.toml:1: `sensor`: expected tables, each under [[sensor]], found a table"
    );
    assert_eq!(said("sensor = []"), "r.toml:1: `sensor` = []: expected tables, each under [[sensor]]");
    assert_eq!(said("\nring = 16"), "r.toml:2: `ring` = 16: expected a table ([ring]), found a number");
}

#[test]
fn text_that_is_no_toml_is_refused_with_its_line() {
    assert_eq!(said("name = \"x\"\nradius 9in\n"), "r.toml:2: no TOML: key with no value, expected `=`");
    assert_eq!(said("[ring]\ncount = 1\ncount = 2\n"), "r.toml:3: no TOML: duplicate key");
    assert!(said("a = \"").starts_with("r.toml:1: no TOML: "));
}

#[test]
fn deep_nesting_is_refused_rather_than_followed() {
    assert!(said(&format!("a = {}", "[".repeat(200_000))).starts_with("r.toml:1: no TOML: "));
    // The TOML parser gives no place for this one.
    assert_eq!(said(&format!("a{} = 1", ".a".repeat(200_000))), "r.toml: no TOML: recursion limit");
}

#[test]
fn unknown_keys_are_named_with_their_line_and_section() {
    assert_eq!(
        said("feild_of_view = \"20deg\"\n"),
        "r.toml:1: unknown key `feild_of_view`; expected one of \
         name, ring, sensor, log, field_of_view, min_range, max_range, range_resolution"
    );
    assert_eq!(
        said(&format!("{RING}first-yaw = \"0deg\"\nabc = 1")),
        "r.toml:4: unknown key `first-yaw` in [ring]; expected one of count, radius, first_yaw"
    );
    let sensor = said("[[sensor]]\nid = \"a\"\n\n[[sensor]]\nid = \"b\"\nz = 1\n");
    assert!(
        sensor.starts_with("r.toml:6: unknown key `z` in [[sensor]]; expected one of id, x, y, yaw, topic, "),
        "{sensor}"
    );
    assert!(log_said("unit = \"mm\"").starts_with("r.toml:5: unknown key `unit` in [log]; expected one of header, "));
    assert!(log_said("[log.poses]\nposes = {}").starts_with("r.toml:6: unknown key `poses` in [log.poses]; "));
}

#[test]
fn missing_keys_are_named_with_their_section() {
    assert_eq!(said("[ring]\nradius = 0.1\n"), "r.toml:1: [ring]: `count` is missing");
    assert_eq!(said("\n[ring]\ncount = 1\n"), "r.toml:2: [ring]: `radius` is missing");
    assert_eq!(said("[[sensor]]\nid = \"a\"\n[[sensor]]\nx = 1\n"), "r.toml:3: [[sensor]]: `id` is missing");
}

#[test]
fn counts_are_whole_and_from_1_to_65535() {
    let count = |value: &str| said(&format!("[ring]\nradius = 0.1\ncount = {value}\n"));
    for value in ["0", "65536", "9223372036854775807", "99999999999999999999"] {
        assert_eq!(count(value), format!("r.toml:3: `ring.count` = {value}: must be 1 to 65535"));
    }
    assert_eq!(count("-1"), "r.toml:3: `ring.count` = -1: must not be negative");
    assert_eq!(count("2.0"), "r.toml:3: `ring.count` = 2.0: expected a whole number, found a number");
    assert_eq!(count("\"16\""), "r.toml:3: `ring.count` = \"16\": expected a whole number, found a string");
    assert_eq!(count("65535"), "");
    assert_eq!(count("0x10"), "");
}

#[test]
fn lengths_out_of_their_domain_are_refused() {
    assert_eq!(
        said("[ring]\ncount = 1\nradius = \"-9in\"\n"),
        "r.toml:3: `ring.radius` = \"-9in\": must be finite and not negative"
    );
    let top = |line: &str| said(&format!("{line}\n{RING}"));
    assert_eq!(top("min_range = -0.1"), "r.toml:1: `min_range` = -0.1: must be finite and not negative");
    assert_eq!(top("max_range = 0"), "r.toml:1: `max_range` = 0: must be above zero");
    assert_eq!(
        top("range_resolution = \"0mm\""),
        "r.toml:1: `range_resolution` = \"0mm\": must be finite and above zero"
    );
    assert_eq!(top("max_range = inf"), "r.toml:1: `max_range` = inf: must be finite");
    assert_eq!(top("min_range = nan"), "r.toml:1: `min_range` = nan: must be finite");
    assert_eq!(top("min_range = 1e400"), "r.toml:1: `min_range` = 1e400: must be finite");
    assert_eq!(top("min_range = 0"), "");
}

#[test]
fn lengths_of_another_kind_are_refused() {
    let top = |line: &str| said(&format!("{line}\n{RING}"));
    assert_eq!(
        top("max_range = \"5 metres\""),
        "r.toml:1: `max_range` = \"5 metres\": `5 metres`: no unit `metres` for a length; expected one of m, cm, mm, in, ft"
    );
    assert_eq!(
        top("max_range = true"),
        "r.toml:1: `max_range` = true: expected a string with a number and a unit, or a number, found a truth value"
    );
}

#[test]
fn angles_need_their_unit() {
    assert_eq!(
        said(&format!("field_of_view = 22.5\n{RING}")),
        "r.toml:1: `field_of_view` = 22.5: `22.5` has no unit: an angle needs one of deg, rad, like `30deg`"
    );
    assert!(said(&format!("{RING}first_yaw = 0\n")).starts_with("r.toml:4: `ring.first_yaw` = 0: `0` has no unit"));
    assert!(
        said("[[sensor]]\nid = \"a\"\nyaw = \"90\"\n").starts_with("r.toml:3: `sensor.yaw` = \"90\": `90` has no unit")
    );
}

#[test]
fn a_field_of_view_is_above_0_and_up_to_180_degrees() {
    let fov = |value: &str| said(&format!("field_of_view = \"{value}\"\n{RING}"));
    for value in ["0deg", "-20deg", "180.0001deg", "3.2rad"] {
        assert_eq!(
            fov(value),
            format!("r.toml:1: `field_of_view` = \"{value}\": must be above 0deg and at most 180deg")
        );
    }
    assert_eq!(fov("180deg"), "");
    assert_eq!(fov("0.001deg"), "");
}

#[test]
fn bounds_at_odds_are_refused_where_the_second_of_them_stands() {
    let sensor = |lines: &str| said(&format!("min_range = 0.5\nmax_range = 2\n[[sensor]]\nid = \"a\"\n{lines}"));
    assert_eq!(sensor("min_range = 2"), "r.toml:5: `sensor.min_range` = 2: must be less than max_range");
    assert_eq!(
        sensor("max_range = 0.4"),
        "r.toml:5: `sensor.max_range` = 0.4: must be more than min_range, which is 0.5 m"
    );
    assert_eq!(sensor("min_range = 3\nmax_range = 4"), "");
    assert_eq!(
        said(&format!("max_range = 1\nmin_range = 1\n{RING}")),
        "r.toml:2: `min_range` = 1: must be less than max_range"
    );
}

#[test]
fn ids_are_strings_that_differ() {
    assert_eq!(
        said("[[sensor]]\nid = \"a\"\n[[sensor]]\nid = \"b\"\n[[sensor]]\nid = \"a\"\n"),
        "r.toml:6: `sensor.id` = \"a\": the sensor of line 2 has this id already"
    );
    assert_eq!(said("[[sensor]]\nid = 0\n"), "r.toml:2: `sensor.id` = 0: expected a string, found a number");
    assert_eq!(said("[[sensor]]\nid = \"\"\n"), "r.toml:2: `sensor.id` = \"\": must not be empty");
}

#[test]
fn more_sensors_than_indices_are_refused() {
    let text: String = (0..65_536).map(|i| format!("[[sensor]]\nid=\"{i}\"\n")).collect();
    assert!(said(&text).ends_with("65536 sensors: at most 65535"), "{}", said(&text));
    let text: String = (0..65_535).map(|i| format!("[[sensor]]\nid=\"{i}\"\n")).collect();
    assert_eq!(parse(&text).unwrap().index_of("65534"), Some(65_534));
}

#[test]
fn an_empty_log_section_is_the_default() {
    assert_eq!(log("").unwrap(), LogFormats::default());
    let default = TableFormat::default();
    assert_eq!((default.header, default.delimiter, default.columns, default.time_shift), (true, None, None, 9));
}

#[test]
fn poses_inherit_what_they_do_not_say_but_the_columns() {
    let formats = log(r#"
        header = false
        delimiter = ";"
        columns = ["t", "a"]
        time_unit = "us"
        range_unit = "cm"
        pose_unit = "mm"
        yaw_unit = "deg"
        no_echo = [0, -1.5]
        [log.poses]
        columns = ["t", "x", "y", "yaw"]
        time_unit = "s"
        pose_unit = "1in"
        "#)
    .unwrap();
    let readings = &formats.readings;
    assert_eq!((readings.header, readings.delimiter, readings.time_shift), (false, Some(b';'), 3));
    assert_eq!((readings.range.apply(7.0), readings.pose.apply(7.0)), (0.07, 0.007));
    assert_eq!(readings.no_echo, [0.0, -1.5]);
    let poses = &formats.poses;
    assert_eq!((poses.header, poses.delimiter, poses.time_shift), (false, Some(b';'), 9));
    assert_eq!((poses.pose.apply(1.0), poses.yaw), (0.0254, readings.yaw));
    assert_eq!(poses.columns.as_deref().unwrap(), ["t", "x", "y", "yaw"]);
}

#[test]
fn naming_the_columns_says_that_there_is_no_header() {
    assert!(!log("columns = [\"t\"]").unwrap().readings.header);
    assert!(log("header = true\ncolumns = [\"t\"]").unwrap().readings.header);
    let poses_with_header = log("columns = [\"t\"]\n[log.poses]\ntime_unit = \"ms\"").unwrap().poses;
    assert!(poses_with_header.header && poses_with_header.columns.is_none());
    assert!(!log("[log.poses]\ncolumns = [\"t\"]").unwrap().poses.header);
}

#[test]
fn a_table_without_header_needs_columns() {
    assert_eq!(log_said("header = false"), "r.toml:4: [log]: header = false needs `columns`, the names of the columns");
    assert_eq!(
        log_said("header = false\ncolumns = [\"t\"]\n[log.poses]\npose_unit = \"mm\""),
        "r.toml:7: [log.poses]: header = false needs `columns`, the names of the columns"
    );
    // Without a section of their own, the poses' file has to name its columns itself.
    assert!(log("header = false\ncolumns = [\"t\"]").unwrap().poses.header);
}

#[test]
fn columns_are_named_once() {
    assert_eq!(
        log_said("columns = [\"t\",\n \"a\",\n \"t\"]"),
        "r.toml:7: `log.columns` = \"t\": this column is named twice"
    );
    assert_eq!(log_said("columns = []"), "r.toml:5: `log.columns` = []: expected at least one name");
    assert_eq!(log_said("columns = \"t\""), "r.toml:5: `log.columns` = \"t\": expected an array, found a string");
    assert_eq!(log_said("columns = [1]"), "r.toml:5: `log.columns` = 1: expected a string, found a number");
}

#[test]
fn delimiters_are_one_ascii_character_outside_numbers() {
    for (text, byte) in [(",", b','), (";", b';'), ("\\t", b'\t'), ("|", b'|'), (" ", b' ')] {
        assert_eq!(log(&format!("delimiter = \"{text}\"")).unwrap().readings.delimiter, Some(byte));
    }
    for text in ["", ",,", "é", "\\\"", "\\n", "5", "e", "-", ".", "\\u0000"] {
        let message = log_said(&format!("delimiter = \"{text}\""));
        assert!(
            message.starts_with("r.toml:5: `log.delimiter` = ") && message.contains("one ASCII character"),
            "{text}: {message}"
        );
    }
}

#[test]
fn units_of_a_table_are_checked() {
    assert_eq!(log_said("time_unit = \"min\""), "r.toml:5: `log.time_unit` = \"min\": expected one of s, ms, us, ns");
    assert_eq!(log_said("range_unit = \"-1mm\""), "r.toml:5: `log.range_unit` = \"-1mm\": must be above zero");
    assert!(log_said("pose_unit = \"deg\"").starts_with("r.toml:5: `log.pose_unit` = \"deg\": `deg` is not a length"));
    assert!(log_said("yaw_unit = 0.1").starts_with("r.toml:5: `log.yaw_unit` = 0.1: `0.1` has no unit"));
    assert!(log_said("range_unit = 0").starts_with("r.toml:5: `log.range_unit` = 0: `0` is out of range"));
    assert_eq!(log("range_unit = 0.001").unwrap().readings.range.apply(2320.0), 2.32);
    assert_eq!(log("yaw_unit = \"-1deg\"").unwrap().readings.yaw.apply(180.0), -PI);
}

#[test]
fn lists_are_bounded() {
    let said = log_said(&format!("no_echo = [{}]", "1, ".repeat(1001)));
    assert_eq!(said, "r.toml:5: `log.no_echo` = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, …: 1001 values: at most 1000");
    let names: Vec<String> = (0..=MAX_FIELDS).map(|index| format!("\"{index}\"")).collect();
    assert!(log_said(&format!("columns = [{}]", names.join(","))).ends_with("131073 values: at most 131072"));
}

#[test]
fn no_echo_values_are_finite_numbers() {
    assert_eq!(log_said("no_echo = [1, nan]"), "r.toml:5: `log.no_echo` = nan: must be finite");
    assert_eq!(
        log_said("no_echo = [\"5110\"]"),
        "r.toml:5: `log.no_echo` = \"5110\": expected a number, found a string"
    );
    assert_eq!(log_said("no_echo = 5110"), "r.toml:5: `log.no_echo` = 5110: expected an array, found a number");
    assert_eq!(log_said("header = 1"), "r.toml:5: `log.header` = 1: expected true or false, found a number");
}

#[test]
fn messages_stay_short_and_printable() {
    let long = said(&format!("name = [{}]", "1, ".repeat(100_000)));
    assert!(long.starts_with("r.toml:1: `name` = [1, 1, ") && long.chars().count() < 150, "{long}");
    let key = said("\"\\u001b[31m\" = 1");
    assert!(key.starts_with("r.toml:1: unknown key `\\u{1b}[31m`"), "{key}");
}

proptest::proptest! {
    #[test]
    fn no_text_makes_it_panic(text: String) {
        let _ = parse(&text);
    }

    #[test]
    fn no_value_makes_it_panic(
        key in "(name|field_of_view|min_range|ring|sensor|log|ring.count|ring.radius|log.columns|log.poses|log.no_echo)",
        value in "(-?[0-9]{1,20}(\\.[0-9]{1,3})?|inf|nan|true|'.{0,8}'|\\[\\]|\\[1,'a'\\]|\\{\\}|\\[\\{\\}\\]|\\{id='a'\\}|1979-05-27)",
    ) {
        let _ = parse(&format!("{key} = {value}"));
    }
}
