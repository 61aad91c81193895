use super::*;

const KEEP: Keep = Keep { from: None, memory: i64::MAX };
const GAP: u64 = 10;

fn at(x: f64) -> Rigid {
    Rigid::flat(x, 0.0, 1.0, 0.0)
}

/// A tree of links `child in parent`, each at a place: at a time, or (at no time) for good.
fn tree(links: &[(&str, &str, Option<i64>, f64)]) -> Tree {
    let mut tree = Tree::default();
    for &(child, parent, t, x) in links {
        let frames = [parent, child].map(|name| tree.frame(name).unwrap());
        let hold = if t.is_some() { Hold::Moment } else { Hold::Forever };
        tree.add(frames, (t.unwrap_or(0), 0), at(x), hold, KEEP).unwrap();
    }
    tree
}

fn lookup(tree: &Tree, frame: &str, other: &str, t: i64) -> Result<f64, Miss> {
    let [frame, other] = [frame, other].map(|name| tree.find(name).unwrap());
    tree.lookup(frame, other, t, GAP).map(|pose| pose.position().0)
}

fn robot() -> Tree {
    tree(&[
        ("sonar", "base", None, 0.5),
        ("camera", "base", None, 2.0),
        ("base", "odom", Some(0), 0.0),
        ("base", "odom", Some(10), 10.0),
        ("base", "odom", Some(40), 40.0),
        ("odom", "map", None, 100.0),
    ])
}

#[test]
fn up_down_and_across() {
    let tree = robot();
    assert_eq!(lookup(&tree, "sonar", "odom", 4), Ok(4.5));
    assert_eq!(lookup(&tree, "sonar", "map", 4), Ok(104.5));
    assert_eq!(lookup(&tree, "odom", "sonar", 4), Ok(-4.5));
    assert_eq!(lookup(&tree, "sonar", "camera", 1_000_000), Ok(-1.5));
    assert_eq!(lookup(&tree, "sonar", "sonar", 4), Ok(0.0));
}

#[test]
fn only_between_poses_that_are_near_enough() {
    let tree = robot();
    let gap = Err(Miss::Gap("`base` in `odom`".into()));
    assert_eq!(lookup(&tree, "sonar", "odom", 40), Ok(40.5));
    for t in [-1, 15, 25, 35, 41] {
        assert_eq!(lookup(&tree, "sonar", "odom", t), gap, "{t}");
    }
}

#[test]
fn a_slash_before_a_name_is_none() {
    let mut tree = robot();
    assert_eq!(tree.frame("/sonar"), Ok(tree.find("sonar").unwrap()));
    assert!(tree.frame("").is_err() && tree.frame("/").is_err() && tree.frame(&"x".repeat(256)).is_err());
}

#[test]
fn two_pieces_are_named_with_what_is_missing() {
    let tree = tree(&[("sonar", "base", None, 1.0), ("other", "odom", Some(0), 1.0)]);
    let Err(Miss::Apart(words)) = lookup(&tree, "sonar", "odom", 0) else { panic!() };
    assert!(words.ends_with("no transform between `odom` and `base`"), "{words}");
}

#[test]
fn loops_and_second_parents_change_nothing() {
    let mut tree = robot();
    let [sonar, map, base] = ["sonar", "map", "base"].map(|name| tree.find(name).unwrap());
    for frames in [[sonar, map], [sonar, base], [map, map]] {
        assert!(tree.add(frames, (0, 0), at(1.0), Hold::Moment, KEEP).is_err(), "{frames:?}");
    }
    assert_eq!(lookup(&tree, "sonar", "map", 4), Ok(104.5));
}

#[test]
fn what_is_said_for_good_holds_and_what_foxglove_says_once_holds_until_it_says_more() {
    let mut tree = robot();
    let [sonar, base] = ["sonar", "base"].map(|name| tree.find(name).unwrap());
    tree.add([base, sonar], (4, 0), at(9.0), Hold::Moment, KEEP).unwrap();
    assert_eq!(lookup(&tree, "sonar", "base", 4), Ok(0.5));
    let laser = tree.frame("laser").unwrap();
    tree.add([base, laser], (4, 0), at(3.0), Hold::UntilNext, KEEP).unwrap();
    assert_eq!((lookup(&tree, "laser", "base", 1_000), tree.moves(laser)), (Ok(3.0), false));
    tree.add([base, laser], (8, 0), at(7.0), Hold::UntilNext, KEEP).unwrap();
    assert_eq!((lookup(&tree, "laser", "base", 6), tree.moves(laser)), (Ok(5.0), true));
    assert!(lookup(&tree, "laser", "base", 1_000).is_err());
}

#[test]
fn frames_are_bounded_and_so_is_what_is_kept_of_one() {
    let mut tree = Tree::default();
    for number in 0..MOST {
        tree.frame(&number.to_string()).unwrap();
    }
    assert!(tree.frame("one more").is_err());
    let mut history = History::default();
    let memory = Keep { from: None, memory: 100 };
    for t in 0..1000 {
        history.add(t, t, at(t as f64), memory);
    }
    assert!(history.at(850, GAP).is_none());
    assert_eq!(history.at(950, GAP).map(|pose| pose.position().0), Some(950.0));
    history.add(1000, 1000, at(1000.0), Keep { from: Some(990), memory: i64::MAX });
    assert!(history.at(989, GAP).is_none() && history.at(990, GAP).is_some());
}
