//! Whose readings are fused: those of one robot, which is known by the namespace of its topics.

use std::collections::BTreeSet;

use super::{
    namespace::{self, are_apart, encloses},
    whereabouts::Wish,
};

/// Namespaces with poses that are remembered, at most.
const MOST: usize = 256;
/// What topics of transforms that hold for good are called.
const STATIC: &str = "tf_static";

/// Which robot it is.
pub(super) struct Home {
    /// The topics of transforms that were asked for; all of them where it is empty.
    transforms: Vec<String>,
    /// Topics of readings that were asked for.
    ranges: Vec<String>,
    /// Namespaces with transforms or poses, but for the outermost.
    namespaces: BTreeSet<String>,
    /// The namespace that was asked for.
    wished: Option<String>,
    /// The topic of the first reading.
    topic: Option<String>,
}

impl Home {
    /// The robot that is asked for by its topics of poses or transforms, else that of the first reading.
    pub(super) fn new(wish: &Wish) -> Self {
        let topics = wish.topic.iter().chain(&wish.transforms).map(|topic| namespace::of(topic));
        let wished = topics.min_by_key(|namespace| namespace.len()).map(str::to_owned);
        let (transforms, ranges) = (wish.transforms.clone(), wish.ranges.clone());
        Self { transforms, ranges, namespaces: BTreeSet::new(), wished, topic: None }
    }

    /// There is a topic that says where things are.
    pub(super) fn expect(&mut self, topic: &str) {
        let namespace = namespace::of(topic);
        if !namespace.is_empty() && self.namespaces.len() < MOST && !self.namespaces.contains(namespace) {
            self.namespaces.insert(namespace.to_owned());
        }
    }

    /// The namespace to which a topic's transforms belong; `None` where they are not wanted.
    pub(super) fn group<'a>(&self, topic: &'a str) -> Option<&'a str> {
        let listed = |wanted: &String| {
            *wanted == topic || (topic.ends_with(STATIC) && encloses(namespace::of(topic), namespace::of(wanted)))
        };
        match self.transforms.is_empty() {
            true => Some(namespace::of(topic)),
            // What is asked for is one robot's.
            false => self.transforms.iter().any(listed).then_some(""),
        }
    }

    /// The first reading decides: returns the namespace from which transforms are looked up, once.
    pub(super) fn settle(&mut self, topic: &str) -> Option<String> {
        if self.topic.is_some() {
            return None;
        }
        self.topic = Some(topic.to_owned());
        Some(self.view().to_owned())
    }

    /// The namespace from which transforms and poses are looked up.
    fn view(&self) -> &str {
        let own = || self.topic.as_deref().map_or("", namespace::of);
        self.wished.as_deref().unwrap_or_else(own)
    }

    /// How near a topic of poses is ([`namespace::nearness`]).
    pub(super) fn nearness(&self, topic: &str) -> Option<usize> {
        namespace::nearness(namespace::of(topic), self.view())
    }

    /// The innermost namespace with poses around a topic; the outermost is none.
    fn around(&self, topic: &str) -> Option<&str> {
        let around = self.namespaces.iter().filter(|namespace| encloses(namespace, namespace::of(topic)));
        around.max_by_key(|namespace| namespace.len()).map(String::as_str)
    }

    /// Whether a topic's readings are this robot's; else the words are whose they are.
    pub(super) fn check(&self, topic: &str) -> Result<(), String> {
        let own = match &self.wished {
            // Who names the topics of the poses and of the readings means both.
            Some(_) if self.ranges.iter().any(|range| range == topic) => return Ok(()),
            Some(wished) => Some(wished.as_str()).filter(|wished| !wished.is_empty()),
            None => self.topic.as_deref().and_then(|topic| self.around(topic)),
        };
        match (own, self.around(topic)) {
            (Some(own), Some(other)) if are_apart(own, other) => Err(format!(
                "its robot has poses of its own under {other}, and those of {own} are used; fuse it by itself with --tf-topics \
                 {other}/tf,{other}/tf_static or --range-topics"
            )),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn home(topic: Option<&str>, transforms: &[&str], first: &str) -> Home {
        let transforms = transforms.iter().map(|topic| (*topic).to_owned()).collect();
        let mut home = Home::new(&Wish { topic: topic.map(str::to_owned), transforms, ..Wish::default() });
        for topic in ["/robot1/tf", "/robot2/tf", "/tf"] {
            home.expect(topic);
        }
        home.settle(first);
        home
    }

    #[test]
    fn the_first_reading_decides_whose_it_is() {
        let mut home = home(None, &[], "/robot2/sonar");
        assert_eq!(home.settle("/robot1/sonar"), None);
        assert!(home.check("/robot2/front/sonar").is_ok() && home.check("/sonar").is_ok());
        assert!(home.check("/robot1/sonar").unwrap_err().contains("--tf-topics /robot1/tf"));
    }

    #[test]
    fn what_is_asked_for_decides_before() {
        assert!(home(Some("/robot1/tf"), &[], "/robot2/sonar").check("/robot2/sonar").is_err());
        assert!(home(None, &["/robot1/tf"], "/robot2/sonar").check("/robot1/sonar").is_ok());
        assert!(home(Some("/tf"), &[], "/robot2/sonar").check("/robot1/sonar").is_ok());
    }

    #[test]
    fn transforms_that_were_asked_for_bring_the_static_ones_around_them() {
        let home = home(None, &["/robot1/tf"], "/sonar");
        for topic in ["/robot1/tf", "/robot1/tf_static", "/tf_static"] {
            assert_eq!(home.group(topic), Some(""), "{topic}");
        }
        assert_eq!((home.group("/tf"), home.group("/robot2/tf_static")), (None, None));
    }
}
