use std::{collections::BTreeMap, fs};

use super::*;

/// Worlds with nothing random in them: one drive is as good as thirty.
const FIXED: [&str; 3] = ["specular-wall", "corners", "pole"];

fn page() -> String {
    fs::read_to_string(page::PAGE).unwrap()
}

/// The cells of a table's lines, but for the rule under its headings.
fn cells(table: &str) -> Vec<Vec<String>> {
    let lines = table.lines().filter(|line| line.starts_with('|') && !line.starts_with("|--"));
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
    lines.map(cells).collect()
}

/// Numbers by row (its first `words` cells) and column.
fn numbers(table: &str, words: usize) -> BTreeMap<(Vec<String>, String), String> {
    let lines = cells(table);
    let (header, rows) = lines.split_first().unwrap();
    let row = |row: &Vec<String>| {
        let (name, numbers) = row.split_at(words);
        let name = name.to_vec();
        let named = header.iter().skip(words).zip(numbers.to_vec());
        named.map(|(column, number)| ((name.clone(), column.clone()), number)).collect::<Vec<_>>()
    };
    rows.iter().flat_map(row).collect()
}

#[test]
fn the_page_shows_what_is_measured() {
    let page = page();
    let mut shown = 0;
    let tables = measured(&FIXED, &["specular-wall"], Effects::default(), 1).unwrap();
    for table in tables.iter().filter(|table| !["curve", "interleaving"].contains(&table.name)) {
        let Some((_, expected, _)) = page::split(&page, &format!("exact {}", table.name)) else { continue };
        assert!(expected.starts_with(&format!("**{}**\n", table.title)), "{expected}");
        let expected = numbers(expected, table.words);
        for (place, number) in numbers(&table.to_string(), table.words) {
            assert_eq!(
                expected.get(&place),
                Some(&number),
                "docs/methods.md, {}: {place:?} (scripts/methods writes it)",
                table.name
            );
            shown += 1;
        }
    }
    assert!(shown > 400, "{shown} numbers compared");
}

#[test]
fn every_place_in_the_page_is_filled_by_a_table() {
    let page = page();
    let driven = measured(&["doorway"], &["specular-wall"], Effects::default(), 1).unwrap();
    let places = page.split("<!-- measured: ").skip(1).map(|rest| rest.split(" -->").next().unwrap());
    for place in places.filter(|place| *place != "recording") {
        let (kind, name) = place.split_once(' ').unwrap();
        assert!(["exact", "noise"].contains(&kind), "{place}");
        let table = driven.iter().find(|table| table.name == name).unwrap_or_else(|| panic!("no table for {place}"));
        let (_, shown, _) = page::split(&page, place).unwrap();
        assert!(shown.starts_with(&format!("**{}**\n", table.title)), "{shown}");
    }
}

#[test]
fn only_the_table_in_its_place_is_changed() {
    let page = "a\n<!-- measured: exact b -->\nold\n<!-- end -->\nc\n<!-- measured: exact d -->\nd\n<!-- end -->\n";
    let before = "a\n<!-- measured: exact b -->\n";
    let after = "<!-- end -->\nc\n<!-- measured: exact d -->\nd\n<!-- end -->\n";
    assert_eq!(page::split(page, "exact b"), Some((before, "old\n", after)));
    assert_eq!(page::split(page, "exact"), None);
    assert_eq!(page::split(page, "noise b"), None);
}

#[test]
fn a_table_reads_as_one_in_its_source() {
    let table = Table {
        name: "t",
        title: "Title",
        header: table::headings(&["", "wide"]),
        words: 1,
        rows: vec![vec!["atm".into(), "0.8".into()], vec!["tbf ±".into(), table::text(None, 1)]],
    };
    assert_eq!(table.to_string(), "**Title**\n\n|       | wide |\n|---|--:|\n| atm   |  0.8 |\n| tbf ± |    - |\n");
}

#[test]
fn the_median_of_an_even_count_is_between_the_middle_ones() {
    let of = |values: &[f64]| drive::median(values.iter().map(|value| Some(*value)).chain([None]));
    assert_eq!((of(&[3.0, 1.0, 2.0]), of(&[4.0, 1.0, 3.0, 2.0]), of(&[])), (Some(2.0), Some(2.5), None));
}
