//! The ordinary record of a table: a line without a quote, whose fields can stay where they are.

/// Seven low bits of each byte.
const LOW: u64 = 0x7f7f_7f7f_7f7f_7f7f;

/// One byte, eight times.
const fn eight(byte: u8) -> u64 {
    u64::from_le_bytes([byte; 8])
}

/// The high bit of each byte of `word` that equals the byte of `of`, and no other.
#[inline(always)]
const fn equal(word: u64, of: u64) -> u64 {
    let differing = word ^ of;
    // The sum carries into the high bit where any low bit differs, and never into the next byte.
    !(((differing & LOW) + LOW) | differing | LOW)
}

/// Finds the fields of the line that `text` begins with, eight bytes at a time: where each ends, and how many there are. The
/// last one ends where the line does.
///
/// `None` where the line holds a quote, or does not end well before `text` does.
#[inline]
pub(super) fn split(text: &[u8], delimiter: u8, ends: &mut Vec<usize>) -> Option<usize> {
    let (words, _) = text.as_chunks::<8>();
    let (delimiters, mut count) = (eight(delimiter), 0);
    for (index, word) in words.iter().enumerate() {
        let word = u64::from_le_bytes(*word);
        if equal(word, eight(b'"')) != 0 {
            return None;
        }
        let line_ends = equal(word, eight(b'\n')) | equal(word, eight(b'\r'));
        let line_end = line_ends & line_ends.wrapping_neg();
        // Up to the first of them, or all where there is none.
        let mut marks = (equal(word, delimiters) | line_end) & (line_end | line_end.wrapping_sub(1));
        if ends.len() < count + 8 {
            ends.resize(2 * count + 8, 0);
        }
        while marks != 0 {
            if let Some(end) = ends.get_mut(count) {
                *end = index * 8 + marks.trailing_zeros() as usize / 8;
            }
            count += 1;
            marks &= marks - 1;
        }
        if line_end != 0 {
            return Some(count);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn fields(text: &[u8]) -> Option<Vec<usize>> {
        let mut ends = vec![0; 2];
        split(text, b',', &mut ends).map(|count| ends[..count].to_vec())
    }

    #[test]
    fn line_without_its_end_or_with_a_quote_is_left_to_the_parser() {
        assert_eq!(fields(b"1,2,3,4,5,6,7,8,9"), None);
        assert_eq!(fields(b"1,2,\"3\",4\n1,2,3,4\n"), None);
        assert_eq!(fields(b""), None);
    }

    #[test]
    fn last_field_ends_with_the_line_whichever_way_that_ends() {
        assert_eq!(fields(b"10,,3\n99,99,99,99"), Some(vec![2, 3, 5]));
        assert_eq!(fields(b"10,,3\r\n9,99,99,99"), Some(vec![2, 3, 5]));
    }

    proptest! {
        #[test]
        fn ends_are_those_of_a_loop_over_bytes(
            text in prop::collection::vec(prop_oneof![Just(b','), Just(b'\n'), Just(b'\r'), Just(b'-'), Just(b'+'), any::<u8>()], 0..64),
        ) {
            let text: Vec<u8> = text.into_iter().filter(|&byte| byte != b'"').collect();
            let line_end = text.iter().position(|byte| b"\r\n".contains(byte));
            let expected = line_end.map(|end| {
                let delimiters = (0..end).filter(|&at| text[at] == b',');
                delimiters.chain([end]).collect::<Vec<_>>()
            });
            // Behind the line, as the rest of a buffer.
            let padded = [&text[..], &[b'x'; 8]].concat();
            prop_assert_eq!(fields(&padded), expected);
        }
    }
}
