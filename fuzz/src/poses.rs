//! Trajectories: the same poses whole and in pieces, and a track over them that is asked in any order.

use std::sync::LazyLock;

use atm::{
    error::Problem,
    log::{Input, poses::PoseLog},
    rig::{Rig, TableFormat},
    track::{PoseStream, StampedPose, Track},
};

use crate::pieces::{pieces, whole};

static ROBOND: LazyLock<TableFormat> =
    LazyLock::new(|| Rig::builtin("robond8").expect("built in").log().expect("its logs").poses.clone());

/// The first byte chooses the format, the second the pieces; the rest is the file.
pub fn check(bytes: &[u8]) {
    let Some((&[options, pattern], file)) = bytes.split_first_chunk() else { return };
    let format = (options & 1 != 0).then(|| &*ROBOND);
    let at_once = read(whole(file), format);
    let in_pieces = read(pieces(file, pattern).0, format);
    assert_eq!(at_once, in_pieces);
    let Ok((poses, _)) = at_once else { return };
    ask(&poses, u64::from(options) << 24);
}

type Said = Result<(Vec<StampedPose>, Vec<Problem>), String>;

fn read(input: Input, format: Option<&TableFormat>) -> Said {
    let mut log = PoseLog::new(input, format).map_err(|error| error.to_string())?;
    let (mut poses, mut problems) = (Vec::new(), Vec::new());
    while let Some(pose) = log.next_pose(&mut |problem| problems.push(problem)).map_err(|error| error.to_string())? {
        let at = pose.pose;
        assert!(at.x.is_finite() && at.y.is_finite() && at.yaw.is_finite(), "{pose:?}");
        poses.push(pose);
    }
    Ok((poses, problems))
}

struct Listed<'a>(std::slice::Iter<'a, StampedPose>);

impl PoseStream for Listed<'_> {
    fn next_pose(&mut self, _: &mut dyn FnMut(Problem)) -> atm::error::Result<Option<StampedPose>> {
        Ok(self.0.next().cloned())
    }
}

/// Poses at and between those there are: finite, and at a pose's own time that pose.
fn ask(poses: &[StampedPose], max_gap: u64) {
    let mut track = Track::new(Listed(poses.iter()), max_gap);
    let mut last: Option<i64> = None;
    for pose in poses {
        for t in [pose.t.saturating_sub(max_gap as i64 / 2), pose.t, pose.t.saturating_add(1)] {
            // Times may not go back.
            if last.is_some_and(|last| t < last) {
                continue;
            }
            let found = track.pose_at(track.resets(), t, &mut |_| ()).expect("a list has no errors");
            if let Some(found) = found {
                last = Some(t);
                assert!(found.x.is_finite() && found.y.is_finite() && found.yaw.is_finite(), "{found:?} at {t}");
            }
        }
    }
}
