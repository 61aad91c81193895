//! How a topic was offered, as recordings say it (`offered_qos_profiles`): whoever plays the file offers it so again.

use std::collections::BTreeMap;

/// The key in a channel's metadata.
const KEY: &str = "offered_qos_profiles";
/// "For ever", the longest time ROS 2 can say.
const FOREVER: &str = "{sec: 9223372036, nsec: 854775807}";

/// Whether who comes late is still given the last message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Durability {
    /// It is: for what is said once.
    TransientLocal,
    /// It is not.
    Volatile,
}

/// How policies are written: by number until Humble, by name since Iron.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Words {
    #[default]
    Numbers,
    Names,
}

impl Words {
    /// What another channel's metadata use; `None` where they say nothing.
    pub(crate) fn of(metadata: &BTreeMap<String, String>) -> Option<Self> {
        let (_, after) = metadata.get(KEY)?.split_once("reliability:")?;
        let first = after.trim_start().chars().next()?;
        Some(if first.is_ascii_digit() { Self::Numbers } else { Self::Names })
    }
}

/// The metadata of a channel that was offered reliably, its last message kept.
pub(crate) fn metadata(durability: Durability, words: Words) -> BTreeMap<String, String> {
    let (history, reliability, durability, liveliness) = match (words, durability) {
        (Words::Numbers, Durability::TransientLocal) => ("1", "1", "1", "1"),
        (Words::Numbers, Durability::Volatile) => ("1", "1", "2", "1"),
        (Words::Names, Durability::TransientLocal) => ("keep_last", "reliable", "transient_local", "automatic"),
        (Words::Names, Durability::Volatile) => ("keep_last", "reliable", "volatile", "automatic"),
    };
    let profile = format!(
        "- history: {history}\n  depth: 10\n  reliability: {reliability}\n  durability: {durability}\n  \
         deadline: {FOREVER}\n  lifespan: {FOREVER}\n  liveliness: {liveliness}\n  \
         liveliness_lease_duration: {FOREVER}\n  avoid_ros_namespace_conventions: false\n"
    );
    BTreeMap::from([(KEY.to_owned(), profile)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_recognised() {
        for words in [Words::Numbers, Words::Names] {
            assert_eq!(Words::of(&metadata(Durability::Volatile, words)), Some(words));
        }
        assert_eq!(Words::of(&BTreeMap::new()), None);
        let unknown = BTreeMap::from([(KEY.to_owned(), "reliability:".to_owned())]);
        assert_eq!(Words::of(&unknown), None);
    }
}
