use std::io::Write;

use proptest::prelude::*;

use super::*;

/// What may be done with a window.
#[derive(Debug, Clone)]
enum Act {
    Need(usize),
    Use(usize),
    Skip(u64),
    GoTo(u64),
}

const LENGTH: u64 = 5 * SIZE as u64;

fn act() -> impl Strategy<Value = Act> {
    // A window full, give or take, and as often a few bytes.
    let some = || prop_oneof![0..40_u64, 0..2 * SIZE as u64];
    prop_oneof![
        (0..=SIZE).prop_map(Act::Need),
        some().prop_map(|count| Act::Use(count as usize)),
        some().prop_map(Act::Skip),
        (0..=LENGTH).prop_map(Act::GoTo),
        // Not far from where it is.
        (0..400_u64).prop_map(|back| Act::GoTo(LENGTH + back)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn wherever_it_goes_it_shows_what_stands_there(acts in prop::collection::vec(act(), 1..40)) {
        let bytes: Vec<u8> = (0..LENGTH).map(|at| (at % 251) as u8).collect();
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(&bytes).unwrap();
        file.rewind().unwrap();
        let mut window = Window::new(Recording::File(file, LENGTH), false);
        for act in acts {
            match act {
                Act::Need(count) => {
                    let left = (LENGTH - window.position()) as usize;
                    prop_assert_eq!(window.need(count).unwrap().len(), count.min(left));
                }
                Act::Use(count) => window.use_up(count),
                Act::Skip(count) => {
                    let count = count.min(LENGTH - window.position());
                    prop_assert_eq!(window.skip(count).unwrap(), count);
                }
                Act::GoTo(place) => {
                    let back = place.saturating_sub(LENGTH);
                    let place = if place > LENGTH { window.position().saturating_sub(back) } else { place };
                    prop_assert!(window.go_to(place).unwrap());
                    prop_assert_eq!(window.position(), place);
                }
            }
            let at = window.position() as usize;
            prop_assert_eq!(window.rest(), &bytes[at..at + window.rest().len()]);
        }
    }
}
