//! The pictures of docs/paper.md and docs/accuracy.md are what the pages' commands draw.
#![cfg(feature = "lab")]

mod support;

use std::{collections::BTreeMap, fs};

use support::*;

/// Set to write the pictures instead of holding them against their commands: `scripts/paper` does.
const WRITE: &str = "ATM_WRITE_PAGE";

/// The commands of the page's console blocks, each as its arguments.
fn commands(page: &str) -> Vec<Vec<String>> {
    let blocks = page.split("```console\n").skip(1).filter_map(|block| block.split_once("```"));
    let lines = blocks.flat_map(|(block, _)| block.split("$ atm ").skip(1));
    lines.map(arguments).collect()
}

/// Words between quotes are one argument.
fn arguments(line: &str) -> Vec<String> {
    let part = |(index, part): (usize, &str)| match index % 2 {
        0 => part.replace("\\\n", " ").split_whitespace().map(str::to_owned).collect(),
        _ => vec![part.to_owned()],
    };
    line.split('\'').enumerate().flat_map(part).collect()
}

/// Holds the pictures of a page whose names begin with `pictures` against what its commands draw.
fn hold(page: &str, pictures: &str) {
    let page = read(root().join(page).to_str().expect("a path in UTF-8"));
    let scratch = Scratch::new();
    let mut drawn = BTreeMap::new();
    for command in commands(&page) {
        // Files of the page are the test's own.
        let place = |word: &String| match word.rsplit_once('.') {
            Some((_, "csv" | "svg")) => scratch.name(&word.replace('/', "_")),
            _ => word.clone(),
        };
        let args: Vec<String> = command.iter().map(place).collect();
        atm(&args).exits(0);
        if let Some(picture) = command.last().filter(|word| word.starts_with(pictures)) {
            drawn.insert(picture.clone(), read(&scratch.name(&picture.replace('/', "_"))));
        }
    }
    let link = |picture: &str| format!("]({}", picture.trim_start_matches("docs/"));
    assert!(!drawn.is_empty() && drawn.len() == page.matches(&link(pictures)).count(), "each picture has a command");
    for (name, drawn) in drawn {
        assert!(page.contains(&format!("{})", link(&name))), "{name} is not shown");
        let path = root().join(&name);
        if std::env::var_os(WRITE).is_some_and(|set| !set.is_empty()) {
            fs::write(path, drawn).expect("the picture can be written");
        } else {
            assert_same(read(path.to_str().expect("a path in UTF-8")).as_bytes(), drawn.as_bytes());
        }
    }
}

#[test]
fn pictures_of_the_papers_claims_are_what_the_commands_beside_them_draw() {
    hold("docs/paper.md", "docs/paper/");
}

#[test]
fn picture_of_the_consensus_is_what_the_commands_beside_it_draw() {
    hold("docs/accuracy.md", "docs/accuracy-doorway");
}
