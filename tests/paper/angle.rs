//! A higher threshold gives fewer points, and finer ones (Sec. IV-D, "Limitations on Accuracy Improvement").

use super::{
    drive::{Drive, PAPER_HISTORY},
    page,
    spread::{cell, median, quantile},
};

const SEEDS: std::ops::RangeInclusive<u64> = 1..=40;
const ANGLES: [f64; 6] = [5.0, 10.0, 20.0, 30.0, 45.0, 60.0];

/// One world under one threshold.
#[derive(Default)]
struct Under {
    crossings: Vec<f64>,
    medians: Vec<f64>,
    errors: Vec<f64>,
}

fn measure(drives: &[Drive], degrees: f64) -> Under {
    let mut under = Under::default();
    for drive in drives {
        let fused = drive.fuse_with(PAPER_HISTORY, degrees);
        under.crossings.push(fused.crossings.len() as f64);
        under.medians.push(fused.medians().len() as f64);
        under.errors.extend(drive.azimuth_errors(&fused.medians()));
    }
    under
}

#[test]
fn higher_threshold_gives_fewer_crossings_and_finer_medians() {
    let mut rows = Vec::new();
    for world in ["doorway", "room"] {
        let drives: Vec<Drive> = SEEDS.map(|seed| Drive::new(world, &[], "", seed)).collect();
        let measured = ANGLES.map(|degrees| measure(&drives, degrees));
        for (degrees, under) in ANGLES.iter().zip(&measured) {
            rows.push(vec![
                world.to_owned(),
                format!("{degrees}°"),
                cell(&under.crossings),
                cell(&under.medians),
                cell(&under.errors),
            ]);
        }
        for pair in measured.windows(2) {
            assert!(median(&pair[1].crossings) < 0.8 * median(&pair[0].crossings), "{world}: fewer");
        }
        // Up to the paper's 30°; beyond it few are left to say anything.
        for pair in measured[..4].windows(2) {
            assert!(median(&pair[1].errors) < median(&pair[0].errors), "{world}: finer");
        }
        assert!(quantile(&measured[3].errors, 0.5) < 0.6, "{world}: {}", quantile(&measured[3].errors, 0.5));
    }
    page::shows("angle", &["world", "θmin", "crossings in a drive", "`median` in a drive", "azimuth error, in"], &rows);
}
