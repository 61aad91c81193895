//! Namespaces of topics: which of them belong to one robot.

/// The namespace of a topic: all before its last name. `/robot1` of `/robot1/tf`; nothing of `/tf`.
pub(super) fn of(topic: &str) -> &str {
    topic.rsplit_once('/').map_or("", |(namespace, _)| namespace)
}

/// Whether what is in `inner` is in `outer`, too.
pub(super) fn encloses(outer: &str, inner: &str) -> bool {
    inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('/') || outer.is_empty())
}

/// Whether neither is in the other.
pub(super) fn are_apart(one: &str, other: &str) -> bool {
    !encloses(one, other) && !encloses(other, one)
}

/// Whether they are called like two robots: where they differ first, they differ in digits alone.
pub(super) fn are_twins(one: &str, other: &str) -> bool {
    let mut pairs = one.split('/').zip(other.split('/'));
    let plain = |name: &str| name.chars().filter(|c| !c.is_ascii_digit()).collect::<String>();
    pairs.find(|(one, other)| one != other).is_some_and(|(one, other)| plain(one) == plain(other))
}

/// How near what is in `namespace` is to whoever looks from `view`, another one: more the deeper it encloses it, 0 where it
/// does not; `None` where it is another robot's.
pub(super) fn nearness(namespace: &str, view: &str) -> Option<usize> {
    match encloses(namespace, view) {
        true => Some(1 + namespace.len()),
        false if are_apart(namespace, view) && are_twins(namespace, view) => None,
        false => Some(0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_namespace_is_what_stands_before_the_last_name() {
        assert_eq!(["/tf", "/robot1/tf", "/a/b/c", "tf", ""].map(of), ["", "/robot1", "/a/b", "", ""]);
    }

    #[test]
    fn enclosing_goes_by_whole_names() {
        assert!(encloses("", "/robot1") && encloses("/robot1", "/robot1") && encloses("/robot1", "/robot1/arm"));
        assert!(!encloses("/robot1", "/robot10") && !encloses("/robot1", "") && !encloses("/robot1/arm", "/robot1"));
    }

    #[test]
    fn robots_are_known_by_their_numbers() {
        assert!(
            are_twins("/robot1", "/robot2") && are_twins("/fleet/r1/x", "/fleet/r2") && are_twins("/robot", "/robot2")
        );
        assert!(!are_twins("/robot1", "/sensors") && !are_twins("/robot1", "/robot1/arm"));
    }

    #[test]
    fn what_encloses_is_nearer_the_deeper_it_does() {
        assert_eq!(nearness("", "/robot1"), Some(1));
        assert_eq!(nearness("/robot1", "/robot1/front"), Some(8));
        assert_eq!(nearness("/base", "/robot1"), Some(0));
        assert_eq!(nearness("/robot1", ""), Some(0));
        assert_eq!(nearness("/robot2", "/robot1"), None);
    }
}
