//! The paths in a crate's sources, and between which modules they lead.
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

/// One module leans on another of the same parent; of several such places, the first.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Arrow {
    /// Path from the crate's root, joined by `::`.
    pub from: String,
    /// As `from`.
    pub to: String,
    /// The module and the path in it.
    pub place: String,
}

type Segments = Vec<String>;

/// The modules of a crate: what paths stand in each, from the crate's root.
type Modules = BTreeMap<Segments, Vec<Segments>>;

/// The arrows between modules below `sources`, each lifted to where the two have one parent.
pub fn arrows(sources: &Path) -> Vec<Arrow> {
    let mut modules = Modules::new();
    collect(sources, &[], &mut modules);
    let mut found = BTreeMap::new();
    for (module, paths) in &modules {
        for path in paths {
            let target = defined(&modules, path);
            let shared = module.iter().zip(&target).take_while(|(a, b)| a == b).count();
            // What a module has of those around it or within it is no arrow.
            if let (Some(_), Some(_)) = (module.get(shared), target.get(shared)) {
                let ends = (module[..=shared].join("::"), target[..=shared].join("::"));
                found.entry(ends).or_insert_with(|| format!("{} in {}", path.join("::"), module.join("::")));
            }
        }
    }
    found.into_iter().map(|((from, to), place)| Arrow { from, to, place }).collect()
}

/// Reads the modules of a directory, which belong to the module `parent`.
fn collect(directory: &Path, parent: &[String], modules: &mut Modules) {
    for entry in fs::read_dir(directory).unwrap_or_else(|error| panic!("{}: {error}", directory.display())) {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let child = [parent, std::slice::from_ref(&name)].concat();
        match name.as_str() {
            "tests" => {}
            _ if path.is_dir() => collect(&path, &child, modules),
            _ if path.extension().is_none_or(|extension| extension != "rs") => {}
            "lib" | "main" | "mod" => read(&path, parent, modules),
            _ => read(&path, &child, modules),
        }
    }
}

fn read(file: &Path, module: &[String], modules: &mut Modules) {
    let text = fs::read_to_string(file).expect("a source");
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let code: String = code.lines().map(|line| line.split("//").next().unwrap_or_default().to_owned() + "\n").collect();
    let paths = modules.entry(module.to_vec()).or_default();
    for (start, _) in code.match_indices("::") {
        let before = &code[..start];
        let word = before.rfind(|c: char| !c.is_alphanumeric() && c != '_').map_or(0, |at| at + 1);
        if ["crate", "super", "self"].contains(&&before[word..]) && !before[..word].ends_with("::") {
            tree(&mut code[word..].chars().peekable(), module, paths);
        }
    }
}

type Chars<'a> = std::iter::Peekable<std::str::Chars<'a>>;

/// Reads `a::{b, c::d}`, and adds each path of it as it is from the crate's root; `base` is where it begins.
fn tree(text: &mut Chars<'_>, base: &[String], paths: &mut Vec<Segments>) {
    let mut path = base.to_vec();
    loop {
        let mut word = String::new();
        while let Some(c) = text.next_if(|c| c.is_alphanumeric() || "_*".contains(*c)) {
            word.push(c);
        }
        match word.as_str() {
            "crate" => path.clear(),
            "self" => {}
            "super" => path.truncate(path.len().saturating_sub(1)),
            _ => path.push(word),
        }
        if text.next_if_eq(&':').is_none() || text.next_if_eq(&':').is_none() {
            break;
        }
        if text.next_if_eq(&'{').is_some() {
            while text.next_if(|c| c.is_whitespace() || *c == ',').is_some() || text.peek().is_some_and(|c| *c != '}') {
                if text.peek().is_some_and(|c| c.is_alphanumeric() || "_*".contains(*c)) {
                    tree(text, &path, paths);
                }
            }
            text.next();
            return;
        }
    }
    paths.push(path);
}

/// The module in which what a path names is defined, through re-exports.
fn defined(modules: &Modules, path: &[String]) -> Segments {
    let (mut path, mut seen) = (path.to_vec(), BTreeSet::new());
    loop {
        let depth = (0..=path.len()).rev().find(|depth| modules.contains_key(&path[..*depth])).unwrap_or(0);
        let Some(item) = path.get(depth) else { return path };
        let module = &path[..depth];
        let same = |known: &&Segments| known.last() == Some(item) && known.len() > 1 && !known.starts_with(module);
        let inner =
            |known: &&Segments| known.last() == Some(item) && known.starts_with(module) && known.len() > depth + 1;
        let paths = &modules[module];
        match paths.iter().find(inner).or_else(|| paths.iter().find(same)) {
            Some(known) if seen.insert(known.clone()) => path = [known, &path[depth + 1..]].concat(),
            _ => return module.to_vec(),
        }
    }
}
