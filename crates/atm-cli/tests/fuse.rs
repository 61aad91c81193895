//! `atm fuse`: the main job on the sample log.

mod support;

use std::collections::HashMap;

use support::*;

/// The sample as a wide table: a row for each sweep, a column for each sensor.
fn wide(rows: &[Row]) -> String {
    let ids: Vec<String> = (0..16).map(|id: i32| id.to_string()).collect();
    let mut table = format!("t,x,y,yaw,{}\n", ids.join(","));
    for sweep in rows.chunks(16) {
        let ranges: Vec<&str> = sweep.iter().map(|row| row.range.as_str()).collect();
        let Row { t, x, y, yaw, .. } = &sweep[0];
        table += &format!("{t},{x},{y},{yaw},{}\n", ranges.join(","));
    }
    table
}

/// A long table of other columns.
fn long(header: &str, cells: impl Fn(&Row) -> String) -> String {
    sample_rows().iter().fold(format!("{header}\n"), |table, row| table + &cells(row) + "\n")
}

#[test]
fn columns_are_the_promised_ones_and_every_number_parses() {
    let ran = fuse_sample(&[]).exits(0);
    assert_eq!(ran.text().lines().next(), Some(HEADER));
    let echoes = ran.echoes();
    assert!(echoes.len() > 500, "{}", echoes.len());
    for echo in &echoes {
        let numbers = [echo.x, echo.y, echo.range, echo.azimuth, echo.resolution, echo.significance];
        assert!(numbers.iter().all(|number| number.is_finite()), "{echo:?}");
        assert!(["median", "single", "center", "near", "pair"].contains(&echo.kind.as_str()), "{echo:?}");
    }
}

#[test]
fn floats_are_the_shortest_that_read_back_the_same() {
    for line in fuse_sample(&[]).text().lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        for cell in [2, 3, 5, 6, 8, 9].map(|column: usize| cells[column]) {
            let digits = |text: &str| text.chars().filter(char::is_ascii_digit).collect::<String>();
            let mantissa = |text: &str| {
                let (mantissa, _) = text.split_once(['e', 'E']).unwrap_or((text, ""));
                digits(mantissa).trim_matches('0').to_owned()
            };
            assert_eq!(mantissa(cell), mantissa(&format!("{:e}", number(cell))), "{line}");
        }
    }
}

#[test]
fn every_echo_lies_on_the_arc_of_its_reading() {
    let rows: HashMap<_, _> = sample_rows().into_iter().map(|row| ((row.t.clone(), row.sensor.clone()), row)).collect();
    for echo in fuse_sample(&[]).echoes() {
        let row = &rows[&echo.key()];
        let (x, y, direction) = row.sensor_pose();
        assert_eq!(Some(echo.range), row.echo(), "{echo:?}");
        assert_near(echo.x, x + echo.range * (direction + echo.azimuth).cos(), 1e-9);
        assert_near(echo.y, y + echo.range * (direction + echo.azimuth).sin(), 1e-9);
        assert!(echo.azimuth.abs() <= BEAM / 2.0 + 1e-12, "{echo:?}");
    }
}

#[test]
fn kind_crossings_resolution_and_significance_belong_together() {
    for echo in fuse_sample(&[]).echoes() {
        let arc = BEAM * echo.range;
        match echo.kind.as_str() {
            "median" => {
                assert!(echo.crossings >= 3, "{echo:?}");
                assert_near(echo.resolution, PAPER_INTERVAL, 1e-12);
                // 1 where the mean of the two middle ones has no crossing near it.
                assert!(echo.significance > 0.0 && echo.significance <= 1.0, "{echo:?}");
            }
            "single" => {
                assert_eq!(echo.crossings, 1, "{echo:?}");
                assert_near(echo.resolution, PAPER_INTERVAL, 1e-12);
                // Equation (1) with one crossing.
                assert_near(echo.significance, PAPER_INTERVAL / arc, 1e-12);
            }
            _ => {
                assert_eq!((echo.kind.as_str(), echo.crossings), ("center", 0), "{echo:?}");
                assert_near(echo.resolution, arc, 1e-12);
                assert_eq!((echo.azimuth, echo.significance), (0.0, 1.0), "{echo:?}");
            }
        }
    }
}

#[test]
fn two_runs_give_the_same_bytes() {
    fuse_sample(&[]).exits(0).writes(fuse_sample(&[]).stdout);
}

#[test]
fn pipes_and_files_give_the_same_bytes() {
    let scratch = Scratch::new();
    let out = scratch.name("echoes.csv");
    let printed = fuse_sample(&[]).exits(0);
    fuse_sample(&["-o", &out]).exits(0).writes_nothing();
    assert_same(read(&out).as_bytes(), &printed.stdout);
    assert_eq!(scratch.list(), ["echoes.csv"]);
    fuse_text(sample(), &["-o", "-"]).exits(0).writes(&printed.stdout);
    fuse_text(sample(), &[]).exits(0).writes(&printed.stdout);
}

#[test]
fn long_and_wide_tables_of_the_same_readings_give_the_same_bytes() {
    let wide = wide(&sample_rows());
    for emit in ["settled", "latest"] {
        let args = ["--emit", emit];
        fuse_text(&wide, &args).exits(0).writes(fuse_sample(&args).exits(0).stdout);
    }
}

#[test]
fn columns_may_come_in_any_order_and_more_are_ignored() {
    let other = long("yaw,note,range,y,sensor,x,t", |row| {
        let Row { t, sensor, range, x, y, yaw } = row;
        format!("{yaw},whatever,{range},{y},{sensor},{x},{t}")
    });
    fuse_text(other, &[]).exits(0).writes(fuse_sample(&[]).stdout);
}

#[test]
fn readings_without_echo_are_normal_in_any_spelling() {
    let spellings = ["nan", "NaN", "NAN", "inf", "-inf", "INF", "-Inf", ""];
    for spelling in spellings {
        let other = long("t,sensor,range,x,y,yaw", |row| {
            let Row { t, sensor, range, x, y, yaw } = row;
            let range = if row.echo().is_some() { range } else { spelling };
            format!("{t},{sensor},{range},{x},{y},{yaw}")
        });
        fuse_text(other, &[]).exits(0).writes(fuse_sample(&[]).stdout);
    }
}

#[test]
fn a_reading_at_the_maximum_is_none_and_one_at_the_minimum_is_an_echo() {
    let log = |range: &str| format!("t,sensor,range,x,y,yaw\n0,0,{range},0,0,0\n");
    let echoes = |range: &str| fuse_text(log(range), &[]).exits(0).echoes().len();
    assert_eq!(["6.477", "6.4769", "0.1524", "0.1523"].map(echoes), [0, 1, 1, 0]);
}

#[test]
fn times_are_read_to_a_nanosecond_and_written_as_the_shortest_decimal() {
    let log = "t,sensor,range,x,y,yaw\n1.50,0,1,0,0,0\n1.6e0,1,1,0,0,0\n1700000000.1234567894,2,1,0,0,0\n";
    let echoes = fuse_text(log, &[]).exits(0).echoes();
    let times: Vec<&str> = echoes.iter().map(|echo| echo.t.as_str()).collect();
    assert_eq!(times, ["1.5", "1.6", "1700000000.123456789"]);
}

#[test]
fn poses_from_a_second_file_do_what_poses_in_the_log_do() {
    let scratch = Scratch::new();
    let bare = long("t,sensor,range", |Row { t, sensor, range, .. }| format!("{t},{sensor},{range}"));
    let (mut csv, mut tum) = (String::from("t,x,y,yaw\n"), String::from("# t x y z qx qy qz qw\n"));
    for row in sample_rows().iter().step_by(16) {
        csv += &format!("{},{},{},{}\n", row.t, row.x, row.y, row.yaw);
        tum += &format!("{} {} {} 0.3 0 0 0 1\n", row.t, row.x, row.y);
    }
    for (name, poses) in [("poses.csv", csv), ("poses.tum", tum)] {
        let poses = scratch.file(name, poses);
        fuse_text(&bare, &["--poses", &poses]).exits(0).writes(fuse_sample(&[]).stdout);
    }
}

#[test]
fn poses_are_interpolated_at_each_reading_yaw_the_shorter_way() {
    let scratch = Scratch::new();
    // From 170 to -170 degrees the shorter way is over 180; a quarter of it leads to 175.
    let poses = scratch.file("poses.csv", "t,x,y,yaw\n0,0,0,2.9670597283903604\n1,4,8,-2.9670597283903604\n");
    let log = "t,sensor,range\n0.25,0,1\n";
    let echoes = fuse_text(log, &["--poses", &poses, "--max-gap", "1s"]).exits(0).echoes();
    let (sin, cos) = 175_f64.to_radians().sin_cos();
    assert_near(echoes[0].x, 1.0 + (1.0 + 9.0 * INCH) * cos, 1e-9);
    assert_near(echoes[0].y, 2.0 + (1.0 + 9.0 * INCH) * sin, 1e-9);
}

#[test]
fn a_rig_file_says_how_a_foreign_table_is_written() {
    let scratch = Scratch::new();
    let columns: Vec<String> = (0..16).map(|id: i32| format!("\"{id}\"")).collect();
    let rig = format!(
        "field_of_view = \"22.5deg\"\nmin_range = \"6in\"\nmax_range = \"255in\"\nrange_resolution = \"1in\"\n\
         [ring]\ncount = 16\nradius = \"9in\"\n\
         [log]\nheader = false\ndelimiter = \" \"\ntime_unit = \"ms\"\nrange_unit = \"mm\"\npose_unit = \"cm\"\n\
         yaw_unit = \"0.1deg\"\nno_echo = [5110]\ncolumns = [\"t\", \"x\", \"y\", \"yaw\", {}]\n",
        columns.join(", ")
    );
    let rig = scratch.file("mine.toml", rig);
    let mut table = String::new();
    for sweep in sample_rows().chunks(16) {
        table += &format!("{}   {} 0  0", 1000.0 * sweep[0].time(), 100.0 * number(&sweep[0].x));
        for row in sweep {
            table += &row.echo().map_or("  5110".into(), |range| format!("  {}", 1000.0 * range));
        }
        table += "\n";
    }
    let log = scratch.file("mine.txt", table);
    let foreign = atm(["fuse", &log, "--rig", &rig]).exits(0).echoes();
    let own = fuse_sample(&[]).echoes();
    assert_eq!(foreign.len(), own.len());
    for (foreign, own) in foreign.iter().zip(&own) {
        assert_eq!((foreign.key(), &foreign.kind, foreign.crossings), (own.key(), &own.kind, own.crossings));
        assert_near(foreign.x, own.x, 1e-9);
        assert_near(foreign.y, own.y, 1e-9);
    }
}

#[test]
fn ids_of_a_rig_of_single_sensors_are_those_of_the_log() {
    let scratch = Scratch::new();
    let rig = "field_of_view = \"30deg\"\nrange_resolution = 0.01\n\
               [[sensor]]\nid = \"left, low\"\nx = \"0.10m\"\ny = \"5cm\"\nyaw = \"90deg\"\n\
               [[sensor]]\nid = \"front\"\nx = 0.2\n";
    let rig = scratch.file("two.toml", rig);
    let log = "t,sensor,range,x,y,yaw\n0,front,1,0,0,0\n0,\"left, low\",2,0,0,0\n";
    let ran = atm_fed(["fuse", "-", "--rig", &rig], log).exits(0);
    let rows: Vec<&str> = ran.text().lines().skip(1).collect();
    assert!(rows[0].starts_with("0.0,front,1.2,0.0,center,1.0,"), "{}", rows[0]);
    let cells: Vec<&str> = rows[1].strip_prefix("0.0,\"left, low\",").expect("the id in quotes").split(',').collect();
    assert_near(number(cells[0]), 0.1, 1e-12);
    assert_near(number(cells[1]), 2.05, 1e-12);
}

#[test]
fn closing_summary_names_every_kind_and_goes_to_standard_error() {
    fuse_sample(&[]).exits(0).says(&["median", "single", "center", "near", "pair", "784", "98"]);
}

#[test]
fn quiet_says_nothing_of_a_clean_run() {
    let quiet = fuse_sample(&["--quiet"]).exits(0).writes(fuse_sample(&[]).stdout);
    assert_eq!(quiet.stderr, "");
}
