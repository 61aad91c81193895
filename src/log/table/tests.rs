use std::sync::atomic::{AtomicU64, Ordering};

use proptest::prelude::*;

use super::*;
use crate::log::{
    Input,
    tests::{broken, input, message, stuttering},
};

fn table_of(input: Input) -> Table {
    Table::new(input.reader, input.name).unwrap()
}

fn delimited(text: impl Into<Vec<u8>>, delimiter: u8) -> Table {
    let mut table = table_of(input(text));
    table.set_delimiter(Some(delimiter)).unwrap();
    table
}

/// Line, byte and fields of every record, and the problems.
type Contents = (Vec<(u64, u64, Vec<String>)>, Vec<Problem>);

fn read_all(table: &mut Table) -> Contents {
    let (mut records, mut problems) = (Vec::new(), Vec::new());
    loop {
        match table.next_record(&mut |problem| problems.push(problem)).unwrap() {
            Next::End => return (records, problems),
            Next::Unusable => {}
            Next::Record => {
                let fields = table.record().fields().map(|field| String::from_utf8_lossy(field).into_owned());
                records.push((table.place().line, table.place().byte, fields.collect()));
            }
        }
    }
}

/// The records of a table without problems, fields joined by `|`, with line and byte.
fn records(mut table: Table) -> Vec<(u64, u64, String)> {
    let (records, problems) = read_all(&mut table);
    assert_eq!(problems, []);
    records.into_iter().map(|(line, byte, fields)| (line, byte, fields.join("|"))).collect()
}

fn at(line: u64, byte: u64, fields: &str) -> (u64, u64, String) {
    (line, byte, fields.to_owned())
}

#[test]
fn fields_are_trimmed_and_may_be_empty() {
    let table = table_of(input("a, b ,\tc\n1,,\n"));
    assert_eq!(records(table), [at(1, 0, "a|b|c"), at(2, 9, "1||")]);
}

#[test]
fn line_ends_may_be_lf_crlf_or_cr() {
    assert_eq!(records(table_of(input("a\nb\nc\n"))), [at(1, 0, "a"), at(2, 2, "b"), at(3, 4, "c")]);
    assert_eq!(records(table_of(input("a\r\nb\r\nc\r\n"))), [at(1, 0, "a"), at(2, 3, "b"), at(3, 6, "c")]);
    assert_eq!(records(table_of(input("a\rb\rc\r"))), [at(1, 0, "a"), at(2, 2, "b"), at(3, 4, "c")]);
}

#[test]
fn the_last_record_needs_no_line_end() {
    assert_eq!(records(table_of(input("a,b\n1,2"))), [at(1, 0, "a|b"), at(2, 4, "1|2")]);
    assert_eq!(records(table_of(input("a,b\n1,"))), [at(1, 0, "a|b"), at(2, 4, "1|")]);
}

#[test]
fn blank_lines_and_comments_are_passed_over_and_counted() {
    let table = table_of(input("\n\r\n# \"a comment\n\na,b\n   \n#\n\n1,2\n# the end"));
    assert_eq!(records(table), [at(5, 17, "a|b"), at(9, 28, "1|2")]);
}

#[test]
fn a_hash_within_a_line_is_no_comment() {
    assert_eq!(records(table_of(input("a,#b\n \"#\",2\n"))), [at(1, 0, "a|#b"), at(2, 5, "\"#\"|2")]);
}

#[test]
fn a_byte_order_mark_is_passed_over_but_counts_as_bytes() {
    assert_eq!(records(table_of(input("\u{feff}a,b\n1,2\n"))), [at(1, 3, "a|b"), at(2, 7, "1|2")]);
    assert_eq!(records(table_of(stuttering("\u{feff}a,b\n1,2\n"))), [at(1, 3, "a|b"), at(2, 7, "1|2")]);
}

#[test]
fn a_byte_order_mark_that_is_not_the_first_thing_is_text() {
    let (second, later) = ("\u{feff}\u{feff}\r\ra,b\n", "#\n\n\u{feff}\r\ra,b\n");
    let made: [fn(&'static str) -> Input; 2] = [|text| input(text), |text| stuttering(text)];
    for made in made {
        assert_eq!(records(table_of(made(second))), [at(1, 3, "\u{feff}"), at(3, 8, "a|b")]);
        assert_eq!(records(table_of(made(later))), [at(3, 3, "\u{feff}"), at(5, 8, "a|b")]);
    }
    let mut long = vec![b'x'; MAX_RECORD + 1];
    long.extend("\n\u{feff}\na,b\n".bytes());
    let (after, problems) = read_all(&mut table_of(input(long)));
    assert_eq!((after.len(), problems.len()), (2, 1));
}

#[test]
fn quotes_hold_delimiters_line_ends_and_doubled_quotes() {
    let mut table = table_of(input("\"a,1\",\"b\"\"\"\n\"c\r\nd\",2\ne,f\n"));
    table.next_record(&mut |_| ()).unwrap();
    assert_eq!(table.lines_of_record(), 1);
    table.next_record(&mut |_| ()).unwrap();
    assert_eq!((table.lines_of_record(), table.record().get(0)), (2, Some(&b"c\r\nd"[..])));
    table.next_record(&mut |_| ()).unwrap();
    assert_eq!((table.place().line, table.place().byte), (4, 21));
    let table = table_of(input("\"a,1\",\"b\"\"\"\n"));
    assert_eq!(records(table), [at(1, 0, "a,1|b\"")]);
}

#[test]
fn runs_of_blanks_and_tabs_count_once() {
    let table = delimited("  1 \t 2\t3  \n \t \n  # no record\n\t4\r\n", b' ');
    assert_eq!(records(table), [at(1, 2, "1|2|3"), at(4, 31, "4")]);
}

#[test]
fn the_delimiter_is_found_in_the_first_record() {
    let found = |text: &str| {
        let mut table = table_of(input(text));
        table.set_delimiter(None).unwrap();
        records(table).pop().unwrap().2
    };
    assert_eq!(found("# a;b;c;d\n\nt,sensor\n1,2\n"), "1|2");
    assert_eq!(found("t;sensor\n1,5;2\n"), "1,5|2");
    assert_eq!(found("t\tsensor\n1\t2\n"), "1|2");
    assert_eq!(found("t  sensor\n 1 \t2\n"), "1|2");
    assert_eq!(found("t;\"a,b,c\";sensor\n1;2;3\n"), "1|2|3");
    assert_eq!(found("t"), "t");
}

#[test]
fn utf_16_is_refused_with_what_to_do() {
    for bytes in [&b"\xff\xfet\0,\0"[..], b"\xfe\xff\0t\0,", b"t\0,\0s\0", b"\0t\0,"] {
        for input in [input(bytes), stuttering(bytes)] {
            let message = message(Table::new(input.reader, input.name));
            assert!(message.contains("UTF-16") && message.contains("convert it to UTF-8"), "{message}");
        }
    }
}

#[test]
fn an_empty_file_is_refused() {
    for text in ["", "\u{feff}"] {
        let input = input(text);
        assert_eq!(message(Table::new(input.reader, input.name)), "log.csv:1: is empty");
    }
}

#[test]
fn a_line_of_3_megabytes_is_passed_over_and_reading_goes_on() {
    let mut text = b"a,b\n\n".to_vec();
    text.resize(text.len() + 3_000_000, b'x');
    text.extend(b"\n1,2\n");
    let mut table = table_of(input(text));
    let (records, problems) = read_all(&mut table);
    let [(1, 0, _), (4, 3_000_006, last)] = &records[..] else { panic!("{records:?}") };
    assert_eq!(last, &["1", "2"]);
    let [problem] = &problems[..] else { panic!("{problems:?}") };
    assert_eq!((problem.reason, problem.place.line, problem.place.byte), (Reason::TooLong, 3, 5));
    assert!(problem.value.contains("3000000 bytes"), "{}", problem.value);
    assert!(table.fields.len() <= 2 * MAX_RECORD && table.ends.len() <= MAX_FIELDS);
}

#[test]
fn the_longest_record_is_read_and_one_byte_more_is_not() {
    for line_end in ["\n", "\r\n", ""] {
        for (length, reasons) in [(MAX_RECORD, &[][..]), (MAX_RECORD + 1, &[Reason::TooLong])] {
            let mut text = vec![b'x'; length];
            text.extend(line_end.as_bytes());
            let (records, problems) = read_all(&mut table_of(input(text)));
            assert_eq!(problems.iter().map(|problem| problem.reason).collect::<Vec<_>>(), reasons);
            assert_eq!(records.len(), 1 - reasons.len());
        }
    }
}

#[test]
fn too_many_fields_are_too_long() {
    let line = |fields: usize| format!("{}\n1,2\n", ",".repeat(fields - 1));
    let (records, problems) = read_all(&mut table_of(input(line(MAX_FIELDS))));
    assert_eq!((records[0].2.len(), records.len(), problems.len()), (MAX_FIELDS, 2, 0));
    let (records, problems) = read_all(&mut table_of(input(line(MAX_FIELDS + 1))));
    assert_eq!((records.len(), problems[0].reason, problems[0].place.line), (1, Reason::TooLong, 1));
}

#[test]
fn a_quote_left_open_swallows_no_more_than_the_longest_record() {
    let rows = 200_000;
    let text = format!("\"a,b\n{}", "1,2,3,4,5\n".repeat(rows));
    let (records, problems) = read_all(&mut table_of(input(text)));
    assert_eq!(problems.len(), 1);
    let (line, byte, fields) = &records[0];
    // Line n + 2 begins at byte 5 + 10 n.
    assert_eq!((*byte - 5) / 10 + 2, *line);
    assert!(*byte <= MAX_RECORD as u64 + 12, "{byte}");
    assert_eq!(fields.len(), 5);
    assert_eq!(records.last().unwrap().0, rows as u64 + 1);
}

#[test]
fn what_was_read_before_an_error_is_given_out() {
    let mut table = table_of(broken("a,b\n1,2\n3,"));
    assert_eq!(table.next_record(&mut |_| ()).unwrap(), Next::Record);
    assert_eq!(table.next_record(&mut |_| ()).unwrap(), Next::Record);
    assert_eq!(message(table.next_record(&mut |_| ())), "log.csv: the disk is on fire");
}

/// Gives out one piece a read.
struct Pieces(std::vec::IntoIter<&'static str>);

impl Read for Pieces {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let piece = self.0.next().unwrap_or_default().as_bytes();
        out[..piece.len()].copy_from_slice(piece);
        Ok(piece.len())
    }
}

/// After each record, whether the table says that it has to wait for the next.
fn waits(pieces: &[&'static str]) -> Vec<bool> {
    let pieces = Vec::from(pieces).into_iter();
    let mut table = Table::new(Box::new(Pieces(pieces)), Arc::from("pipe")).unwrap();
    let mut waits = Vec::new();
    while table.next_record(&mut |_| ()).unwrap() == Next::Record {
        waits.push(table.drained());
    }
    waits
}

#[test]
fn a_table_knows_when_it_has_to_wait() {
    assert_eq!(waits(&["a,b\n1,2\n", "3,4\n"]), [false, true, true]);
    assert_eq!(waits(&["a,b\r\n1,2\r\n", "3,4\r\n"]), [false, true, true]);
    assert_eq!(waits(&["a,b\n1,2\n3", ",4\n"]), [false, true, true]);
    assert_eq!(waits(&["a,b\n1,2\n\n  \n# comment\n", "3,4\n"]), [false, true, true]);
    assert_eq!(waits(&["a,b\n\"1\n2\",\"3\n", "4\"\n"]), [true, true]);
    assert_eq!(waits(&["a,b\n\"1\n2\",3\n", "4,5\n"]), [false, true, true]);
}

#[test]
fn a_quote_opens_a_field_only_at_its_start() {
    // The one within a field is text: the two of them do not close one another.
    assert_eq!(waits(&["a,b\n1\",\"2\n", "3\",4\n"]), [true, true]);
    assert_eq!(waits(&["a,b\n1\",2\n", "3,4\n"]), [false, true, true]);
    // Behind a closed field, text and quotes are text.
    assert_eq!(waits(&["a,b\n\"1\"x\",2\n", "3,4\n"]), [false, true, true]);
    assert_eq!(waits(&["a,b\n\"1\"\"\n\",2\n", "3,4\n"]), [false, true, true]);
}

#[test]
fn a_record_of_an_empty_field_is_no_record_to_wait_for() {
    assert_eq!(waits(&["a,b\n\"\"\n\" \n\"\n", "3,4\n"]), [true, true]);
}

/// Counts the reads.
struct Counted {
    reader: Box<dyn Read + Send>,
    reads: Arc<AtomicU64>,
}

impl Read for Counted {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        self.reads.fetch_add(1, Ordering::Relaxed);
        self.reader.read(out)
    }
}

#[test]
fn the_position_counts_every_byte() {
    let text = "\u{feff}a,b\r\n\r\n# comment\r\n1,2\r\n\r\n";
    let mut table = table_of(input(text));
    read_all(&mut table);
    assert_eq!(table.position(), text.len() as u64);
}

proptest! {
    #[test]
    fn a_stuttering_reader_gives_the_same_records(text in "[a1,\"\r\n# \t]{1,80}", blanks: bool) {
        let delimiter = if blanks { b' ' } else { b',' };
        let read = |input: Input| {
            let mut table = table_of(input);
            table.set_delimiter(Some(delimiter)).unwrap();
            read_all(&mut table)
        };
        prop_assert_eq!(read(input(text.clone())), read(stuttering(text)));
    }

    #[test]
    fn a_table_that_need_not_wait_does_not(text in "[a1,\"\r\n# \t]{1,80}", blanks: bool) {
        let reads = Arc::new(AtomicU64::new(0));
        let reader = Box::new(Counted { reader: stuttering(text).reader, reads: Arc::clone(&reads) });
        let mut table = Table::new(reader, Arc::from("pipe"))?;
        table.set_delimiter(Some(if blanks { b' ' } else { b',' }))?;
        let mut next = Next::Record;
        while next == Next::Record {
            let (waits, before) = (table.drained(), reads.load(Ordering::Relaxed));
            next = table.next_record(&mut |_| ())?;
            prop_assert!(waits || reads.load(Ordering::Relaxed) == before);
        }
    }

    #[test]
    fn each_record_begins_at_its_byte_and_line(text in "[a1,\n# ]{1,80}") {
        for (line, byte, fields) in read_all(&mut table_of(input(text.clone()))).0 {
            let (before, rest) = text.split_at(byte as usize);
            prop_assert!(before.is_empty() || before.ends_with('\n'));
            prop_assert_eq!(before.matches('\n').count() as u64 + 1, line);
            let expected: Vec<_> = rest.lines().next().unwrap().split(',').map(str::trim).collect();
            prop_assert_eq!(fields, expected);
        }
    }
}

/// Text of lines, quotes, comments and blanks, mostly of ordinary lines.
fn lines() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        12 => "[0-9.,-]{1,12}",
        4 => Just("\n".to_owned()),
        2 => Just("\r\n".to_owned()),
        1 => "[\r\"# \t]{1,3}",
    ];
    prop::collection::vec(piece, 0..60).prop_map(|pieces| format!("a,b\n{}", pieces.concat()).into_bytes())
}

proptest! {
    #[test]
    fn lines_that_stay_in_place_are_read_as_the_parser_reads_them(text in lines(), delimiter in prop::sample::select(b",;.".to_vec())) {
        let whole = read_all(&mut delimited(text.clone(), delimiter));
        // Byte by byte, no line is ever complete when it is begun.
        let mut pieces = table_of(stuttering(text));
        pieces.set_delimiter(Some(delimiter)).unwrap();
        prop_assert_eq!(whole, read_all(&mut pieces));
    }

    #[test]
    fn whether_there_is_a_complete_record_is_remembered_rightly(text in lines()) {
        let mut table = table_of(input([&text[..], &[b'x'; 1 << 17]].concat()));
        while table.buffer.fills() < 2 && table.next_record(&mut |_| ()).unwrap() == Next::Record {
            prop_assert_eq!(table.drained(), table.holds_no_record(table.buffer.rest()));
        }
    }
}
