//! exploration
mod drive;
use atm::{core::Kind, eval::doorway::Gap};
use drive::*;

fn q(mut v: Vec<f64>, p: f64) -> f64 {
    v.sort_by(f64::total_cmp);
    if v.is_empty() {
        return f64::NAN;
    }
    let x = (v.len() - 1) as f64 * p;
    let i = x.floor() as usize;
    let j = (i + 1).min(v.len() - 1);
    v[i] + (v[j] - v[i]) * (x - i as f64)
}
fn show(name: &str, v: Vec<f64>) {
    println!(
        "{name}: n={} p10 {:.2} p25 {:.2} p50 {:.2} p75 {:.2} p90 {:.2} p95 {:.2} min {:.2} max {:.2}",
        v.len(),
        q(v.clone(), 0.1),
        q(v.clone(), 0.25),
        q(v.clone(), 0.5),
        q(v.clone(), 0.75),
        q(v.clone(), 0.9),
        q(v.clone(), 0.95),
        q(v.clone(), 0.0),
        q(v, 1.0)
    );
}
fn width(d: &Drive, jambs: [atm::core::Point2<f64>; 2], e: &[atm::eval::Estimate]) -> f64 {
    let _ = d;
    let p: Vec<_> = e.iter().map(|e| e.position).collect();
    Gap::between(jambs, &p).width() / INCH
}

#[test]
fn explore() {
    let _ = LEFT;
    for set in [vec![("opening", "36in"), ("distance", "70in")], vec![("opening", "30in"), ("distance", "60in")]] {
        let mut rows: std::collections::BTreeMap<&str, Vec<f64>> = Default::default();
        for seed in 1..=200 {
            let d = Drive::new("doorway", &set, "", seed);
            let f = d.fuse();
            let jambs = d.world.openings()[0].jambs;
            let i = Drive::with_rig("doorway", &set, "", seed, interleaved());
            let c = Drive::new("closed-wall", &set, "", seed);
            let cf = c.fuse();
            let plain = d.fuse_with(10, 1.0);
            for (n, e) in [
                ("a centers", d.centers()),
                ("b interleaved", i.centers()),
                ("c all", f.all()),
                ("d medians", f.medians()),
                ("e med+single", f.crossed()),
                ("f crossings 1deg", plain.crossing_points()),
                ("g crossings 30", f.crossing_points()),
            ] {
                rows.entry(n).or_default().push(width(&d, jambs, &e));
            }
            for (n, e) in [
                ("h closed centers", c.centers()),
                ("i closed medians", cf.medians()),
                ("j closed med+single", cf.crossed()),
            ] {
                rows.entry(n).or_default().push(width(&c, jambs, &e));
            }
            rows.entry("k az centers").or_default().extend(d.azimuth_errors(&d.centers()));
            rows.entry("l az interleaved").or_default().extend(i.azimuth_errors(&i.centers()));
            rows.entry("m az medians").or_default().extend(d.azimuth_errors(&f.medians()));
        }
        println!("{set:?}");
        for (n, v) in rows {
            show(n, v);
        }
    }
    for (w, p) in [
        ("specular-wall", "straight"),
        ("specular-wall", "weaving"),
        ("rough-wall", "straight"),
        ("diffuse-wall", "straight"),
        ("diffuse-wall", "weaving"),
    ] {
        let mut kinds = [0; 5];
        let (mut shift, mut cx, mut err, mut cerr) = (vec![], vec![], vec![], vec![]);
        for seed in 1..=30 {
            let d = Drive::new(w, &[("path", p)], "", seed);
            let f = d.fuse();
            for e in &f.echoes {
                kinds[Kind::ALL.iter().position(|k| *k == e.kind).unwrap()] += 1;
            }
            shift.extend(f.crossed().iter().map(|e| 70.0 - e.position.y / INCH));
            cx.extend(f.crossing_points().iter().map(|e| 70.0 - e.position.y / INCH));
            err.extend(d.azimuth_errors(&f.crossed()));
            cerr.extend(d.azimuth_errors(&d.centers()));
        }
        println!("{w} {p} kinds {:?} {kinds:?}", Kind::ALL);
        show("  shift med+single", shift);
        show("  shift crossings", cx);
        show("  az err crossed", err);
        show("  az err centers", cerr);
    }
    for h in [8, 9, 10, 11, 12, 13, 14, 16, 20] {
        for w in ["straight"] {
            let (mut n, mut e, mut near) = (vec![], vec![], vec![]);
            for s in 0..30 {
                let l = format!("{}in", 240.0 + s as f64 / 3.0);
                let d = Drive::new("pole", &[("length", &l), ("path", w), ("distance", "100in")], "", s);
                let f = d.fuse_with(h, 30.0);
                n.push(f.medians().len() as f64);
                e.extend(d.azimuth_errors(&f.medians()));
                // only abreast
                near.extend(d.azimuth_errors(&f.crossed()));
            }
            println!("H={h} {w}");
            show("   medians", n);
            show("   err", e);
            show("   err crossed", near);
        }
    }
    for world in ["room", "doorway", "corners", "rough-wall"] {
        for a in [5.0, 10.0, 20.0, 30.0, 45.0, 60.0] {
            let (mut n, mut e, mut x) = (vec![], vec![], vec![]);
            for s in 1..=30 {
                let d = Drive::new(world, &[], "", s);
                let f = d.fuse_with(10, a);
                n.push(f.medians().len() as f64);
                x.push(f.crossings.len() as f64);
                e.extend(d.azimuth_errors(&f.medians()));
            }
            println!("{world} θ={a}");
            show("   crossings", x);
            show("   medians", n);
            show("   err", e);
        }
    }
}
