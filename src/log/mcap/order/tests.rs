use super::*;

/// What comes out of readings that are named by their times, each with the time of its recording; `|` is a clock set back, what is
/// late stands in brackets.
fn order(window: u64, readings: &[(i64, u64)]) -> String {
    let mut order = Order::new(window);
    let mut out = Vec::new();
    let mut empty = |order: &mut Order<i64>| {
        while let Some(what) = order.pop() {
            out.push(match what {
                Out::Next(t) => t.to_string(),
                Out::Late(t) => format!("({t})"),
                Out::SetBack => "|".to_owned(),
            });
        }
    };
    for &(t, log_time) in readings {
        order.goes_on(log_time);
        order.push(t, log_time, t);
        empty(&mut order);
    }
    order.end();
    empty(&mut order);
    out.join(" ")
}

#[test]
fn what_is_out_of_order_within_the_window_is_put_in_order() {
    assert_eq!(order(2, &[(1, 1), (3, 2), (2, 3), (5, 4), (4, 5)]), "1 2 3 4 5");
}

#[test]
fn what_comes_later_than_the_window_is_late() {
    assert_eq!(order(2, &[(10, 1), (11, 3), (12, 5), (9, 6), (13, 7)]), "10 11 (9) 12 13");
    assert_eq!(order(2, &[(10, 1), (11, 3), (9, 6)]), "10 11 (9)");
}

#[test]
fn without_a_window_nothing_waits() {
    assert_eq!(order(0, &[(2, 1), (1, 2), (3, 3)]), "2 (1) 3");
}

#[test]
fn one_time_far_ahead_waits_and_does_no_harm() {
    assert_eq!(order(2, &[(1, 1), (1000, 2), (3, 3), (4, 6), (5, 9), (6, 12)]), "1 3 4 5 6 1000");
}

#[test]
fn equal_times_keep_the_order_of_the_file() {
    let mut order = Order::new(5);
    for (number, log_time) in [(0, 3), (1, 2), (2, 1)] {
        order.push(7, log_time, number);
    }
    order.end();
    assert_eq!([order.pop(), order.pop(), order.pop()], [0, 1, 2].map(|number| Some(Out::Next(number))));
}

#[test]
fn sixteen_late_ones_in_a_row_are_a_clock_set_back() {
    let before = (100..103).map(|t| (t, t as u64));
    let after = (0..17).map(|t| (t, 110 + t as u64));
    let readings: Vec<_> = before.chain(after).collect();
    let expected = format!("100 101 102 | {}", (0..17).map(|t| t.to_string()).collect::<Vec<_>>().join(" "));
    assert_eq!(order(2, &readings), expected);
}

#[test]
fn sixteen_late_ones_within_a_window_are_late() {
    let before = (100..103).map(|t| (t, t as u64));
    let late = (0..16).map(|t| (t, 110));
    let readings: Vec<_> = before.chain(late).chain([(103, 111)]).collect();
    let late = (0..16).map(|t| format!("({t})")).collect::<Vec<_>>().join(" ");
    assert_eq!(order(2, &readings), format!("100 101 102 {late} 103"));
}

#[test]
fn fifteen_late_ones_are_late() {
    let before = (100..103).map(|t| (t, t as u64));
    let late = (0..15).map(|t| (t, 110 + t as u64));
    let readings: Vec<_> = before.chain(late).chain([(103, 130)]).collect();
    let late = (0..15).map(|t| format!("({t})")).collect::<Vec<_>>().join(" ");
    assert_eq!(order(2, &readings), format!("100 101 102 {late} 103"));
}
