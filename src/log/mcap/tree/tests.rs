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
        let group = tree.group("").unwrap();
        tree.add(group, frames, (t.unwrap_or(0), 0), at(x), hold, KEEP).unwrap();
    }
    tree
}

fn lookup(tree: &Tree, frame: &str, other: &str, t: i64) -> Result<f64, Miss> {
    let [frame, other] = [frame, other].map(|name| tree.find(name).unwrap());
    tree.lookup(frame, other, t, &PoseLimits::from(GAP)).map(|(pose, _)| pose.position().0)
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
    let step = Step { distance: 30.0, turn: 0.0 };
    let wide = PoseMiss::Gap { between: 30, step };
    assert_eq!(lookup(&tree, "sonar", "odom", 40), Ok(40.5));
    for (t, miss) in [(-1, PoseMiss::Before(1)), (15, wide), (25, wide), (35, wide), (41, PoseMiss::After(1))] {
        assert_eq!(lookup(&tree, "sonar", "odom", t), Err(Miss::Gap("`base` in `odom`".into(), miss)), "{t}");
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
        assert!(tree.add(0, frames, (0, 0), at(1.0), Hold::Moment, KEEP).is_err(), "{frames:?}");
    }
    assert_eq!(lookup(&tree, "sonar", "map", 4), Ok(104.5));
}

#[test]
fn what_is_said_for_good_holds_and_what_foxglove_says_once_holds_until_it_says_more() {
    let mut tree = robot();
    let [sonar, base] = ["sonar", "base"].map(|name| tree.find(name).unwrap());
    tree.add(0, [base, sonar], (4, 0), at(9.0), Hold::Moment, KEEP).unwrap();
    assert_eq!(lookup(&tree, "sonar", "base", 4), Ok(0.5));
    let laser = tree.frame("laser").unwrap();
    tree.add(0, [base, laser], (4, 0), at(3.0), Hold::UntilNext, KEEP).unwrap();
    assert_eq!((lookup(&tree, "laser", "base", 1_000), tree.moves(laser)), (Ok(3.0), false));
    tree.add(0, [base, laser], (8, 0), at(7.0), Hold::UntilNext, KEEP).unwrap();
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
    let limits = PoseLimits::from(GAP);
    assert!(history.at(850, &limits).is_err());
    assert_eq!(history.at(950, &limits).map(|(pose, _)| pose.position().0), Ok(950.0));
    history.add(1000, 1000, at(1000.0), Keep { from: Some(990), memory: i64::MAX });
    assert!(history.at(989, &limits).is_err() && history.at(990, &limits).is_ok());
}

/// Two robots that call their frames the same, one of them at 100 m.
fn two_robots() -> Tree {
    let mut tree = Tree::default();
    let frames = ["odom", "base"].map(|name| tree.frame(name).unwrap());
    for (namespace, x) in [("/robot1", 0.0), ("/robot2", 100.0)] {
        let group = tree.group(namespace).unwrap();
        for t in [0, 10] {
            tree.add(group, frames, (t, t), at(x), Hold::Moment, KEEP).unwrap();
        }
    }
    tree
}

#[test]
fn a_frame_is_where_the_nearest_namespace_has_it() {
    let mut tree = two_robots();
    for (view, x) in [("/robot1", 0.0), ("/robot2/front", 100.0)] {
        tree.look_from(view);
        assert_eq!(lookup(&tree, "base", "odom", 5), Ok(x), "{view}");
    }
    // What encloses both serves who has none of its own.
    let [odom, base] = ["odom", "base"].map(|name| tree.find(name).unwrap());
    let all = tree.group("").unwrap();
    tree.add(all, [odom, base], (0, 0), at(7.0), Hold::Forever, KEEP).unwrap();
    tree.look_from("/robot3");
    assert_eq!(lookup(&tree, "base", "odom", 5), Ok(7.0));
}

#[test]
fn a_frame_of_several_namespaces_that_are_equally_far_is_contested() {
    let mut tree = two_robots();
    tree.look_from("");
    let Err(Miss::Contested(words)) = lookup(&tree, "base", "odom", 5) else { panic!() };
    assert!(words.contains("/robot1 and /robot2") && words.contains("--tf-topics /robot1/tf"), "{words}");
    // Of one robot's readings another's transforms are none.
    tree.look_from("/robot3");
    assert!(matches!(lookup(&tree, "base", "odom", 5), Err(Miss::Apart(_))));
}

#[test]
fn poses_that_jump_to_and_fro_are_none() {
    let mut history = History::default();
    for k in 0..20 {
        history.add(k, k, at(if k % 2 == 0 { 0.0 } else { 1.0 }), KEEP);
    }
    assert!(history.doubts().are_serious());
    let limits = PoseLimits::from(GAP);
    assert!(matches!(history.at(7, &limits), Err(PoseMiss::Alternating { .. })));
    let mut steady = History::default();
    for k in 0..20 {
        steady.add(k, k, at(k as f64), KEEP);
    }
    assert!(!steady.doubts().are_serious() && steady.at(7, &limits).is_ok());
    for k in 0..20 {
        steady.add(k, k, at(k as f64 + 0.5), KEEP);
    }
    assert_eq!(steady.doubts().contradicted, 20);
}
