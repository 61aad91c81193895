//! How to fuse, as Python says it.

use atm::{
    core::{Beam, Bounds, Consensus, Held, MinAngle, OnNone, OnTwo, RangeResolution, TransversalMedian, Travel},
    echo::AnyEstimator,
    pipeline::{Defaults, Emit, History, SensorModel, Settings},
    rig::Rig,
    storage::LatestSlots,
};
use pyo3::{prelude::*, types::PyString};

use crate::{argument, raise, time};

/// The options that `fuse`, `crossings` and `Fuser` share.
pub struct Options<'a> {
    pub map: LocalMap<'a>,
    pub min_angle: Option<f64>,
    pub range_resolution: Option<f64>,
    pub field_of_view: Option<f64>,
    pub emit: &'a str,
    pub on_none: &'a str,
    pub on_two: &'a str,
    pub max_age: Option<f64>,
    pub max_travel: Option<f64>,
    pub min_step: Option<f64>,
    pub drop_held: bool,
    pub held: Option<&'a str>,
    pub choice: Choice<'a>,
}

/// Which readings the local map holds, as Python says it; `None` for what the library chooses.
#[derive(Clone, Copy)]
pub struct LocalMap<'a> {
    pub history: Option<usize>,
    pub reach: Option<f64>,
    pub preset: Option<&'a str>,
}

impl LocalMap<'_> {
    /// The rule.
    pub fn history(&self) -> PyResult<History> {
        if let Some(preset) = self.preset {
            let paper = argument::choice("preset", preset, &[("paper", History::PAPER)])?;
            return match (self.history, self.reach) {
                (None, None) => Ok(paper),
                _ => Err(raise::value("preset", "goes without history and reach")),
            };
        }
        if let Some(reach) = self.reach.filter(|reach| !(*reach > 0.0 && reach.is_finite())) {
            return Err(raise::value("reach", format_args!("{} m is no positive length", argument::float(reach))));
        }
        Ok(match (self.reach, self.history) {
            (None, Some(count)) => History::ByCount(count),
            (reach, most) => History::ByTravel { reach, most: most.unwrap_or(History::MOST) },
        })
    }
}

/// The estimator, and what only the consensus asks for.
#[derive(Clone, Copy)]
pub struct Choice<'a> {
    pub estimator: &'a str,
    pub confidence: Option<f64>,
    pub range_error: Option<f64>,
}

impl Choice<'_> {
    /// The median.
    pub const ATM: Self = Self { estimator: "atm", confidence: None, range_error: None };

    /// The estimator: the median, or the consensus in its place.
    pub fn estimator(&self, median: TransversalMedian<f64>) -> PyResult<AnyEstimator> {
        let chosen = argument::choice("estimator", self.estimator, &[("atm", false), ("consensus", true)])?;
        let options = [
            (chosen && median.on_none != OnNone::Center, "on_none"),
            (chosen && median.on_two != OnTwo::Drop, "on_two"),
            (!chosen && self.confidence.is_some(), "confidence"),
            (!chosen && self.range_error.is_some(), "range_error"),
        ];
        if let Some((_, name)) = options.into_iter().find(|(given, _)| *given) {
            return Err(raise::value(name, format_args!("says nothing to the estimator {}", self.estimator)));
        }
        if !chosen {
            return Ok(AnyEstimator::Median(median));
        }
        let mut consensus = Consensus::new(median.min_angle);
        if let Some(confidence) = self.confidence {
            let sure = consensus.with_min_confidence(confidence);
            consensus = sure.map_err(|error| raise::value("confidence", format_args!("{confidence}: {error}")))?;
        }
        let metres = self.range_error.unwrap_or(0.0);
        let told = consensus.with_range_error(metres);
        told.map(AnyEstimator::Consensus)
            .map_err(|error| raise::value("range_error", format_args!("{metres} m: {error}")))
    }
}

impl Options<'_> {
    /// What holds where the rig says nothing.
    pub fn defaults(&self) -> PyResult<Defaults> {
        defaults(self.field_of_view, self.range_resolution)
    }

    /// How the library is to fuse.
    pub fn settings(&self) -> PyResult<Settings> {
        Ok(Settings {
            emit: emit(self.emit)?,
            history: self.map.history()?,
            bounds: self.bounds()?,
            estimator: self.choice.estimator(TransversalMedian {
                min_angle: min_angle(self.min_angle)?,
                on_none: on_none(self.on_none)?,
                on_two: on_two(self.on_two)?,
            })?,
            // Everything was checked: what can't be used all the same must not be lost silently.
            strict: true,
        })
    }

    fn bounds(&self) -> PyResult<Bounds<f64>> {
        let bounds = Bounds::NONE.with_held(held(self.held, self.drop_held)?);
        bounded(bounds, self.max_age.map(|age| max_age("max_age", age)).transpose()?, self.max_travel, self.min_step)
    }
}

/// What becomes of a reading equal to its sensor's previous one.
pub fn held(held: Option<&str>, drop_held: bool) -> PyResult<Held> {
    let choices = [("keep", Held::Keep), ("drop", Held::Drop), ("edges", Held::Edges)];
    match held {
        None if drop_held => Ok(Held::Drop),
        None => Ok(Held::Keep),
        Some(_) if drop_held => Err(raise::value("held", "goes without drop_held")),
        Some(word) => argument::choice("held", word, &choices),
    }
}

/// What holds where the rig says nothing.
pub fn defaults(field_of_view: Option<f64>, range_resolution: Option<f64>) -> PyResult<Defaults> {
    let beam = field_of_view.map(Beam::new).transpose();
    let resolution = range_resolution.map(RangeResolution::new).transpose();
    Ok(Defaults {
        field_of_view: beam.map_err(|error| raise::value("field_of_view", error))?,
        range_resolution: resolution.map_err(|error| raise::value("range_resolution", error))?,
    })
}

/// θmin.
pub fn min_angle(radians: Option<f64>) -> PyResult<MinAngle<f64>> {
    let Some(radians) = radians else { return Ok(MinAngle::PAPER) };
    MinAngle::new(radians)
        .map_err(|error| raise::value("min_angle", format_args!("{} rad: {error}", argument::float(radians))))
}

/// The bounds on the local map; lengths in metres.
pub fn bounded(
    mut bounds: Bounds<f64>,
    max_age: Option<u64>,
    max_travel: Option<f64>,
    min_step: Option<f64>,
) -> PyResult<Bounds<f64>> {
    if let Some(age) = max_age {
        bounds = bounds.with_max_age(age);
    }
    if let Some(metres) = max_travel {
        let travel = Travel::from_metres(metres).map_err(|error| raise::value("max_travel", error))?;
        bounds = bounds.with_max_travel(travel);
    }
    match min_step {
        Some(metres) => bounds.with_min_step(metres).map_err(|error| raise::value("min_step", error)),
        None => Ok(bounds),
    }
}

/// A time in seconds, above zero, as nanoseconds.
pub fn max_age(argument: &str, seconds: f64) -> PyResult<u64> {
    let nanoseconds = time::nanoseconds(seconds).and_then(|age| u64::try_from(age).ok()).filter(|age| *age > 0);
    nanoseconds.ok_or_else(|| raise::value(argument, format_args!("{seconds} s is no time above zero")))
}

/// A number of readings; `None` and "auto" are as many as serve.
pub fn history(value: &Bound<'_, PyAny>) -> PyResult<Option<usize>> {
    if value.is_none() || value.extract::<String>().is_ok_and(|word| word == "auto") {
        return Ok(None);
    }
    let most = LatestSlots::<f64>::MAX_HISTORY;
    let history = argument::whole("history", value)?;
    if (1..=most).contains(&history) {
        return Ok(Some(history));
    }
    Err(raise::value("history", format_args!("{value} is not in 1..={most}")))
}

/// When echoes are reported.
pub fn emit(word: &str) -> PyResult<Emit> {
    argument::choice("emit", word, &[("settled", Emit::Settled), ("latest", Emit::Latest)])
}

/// What no crossing gives.
pub fn on_none(word: &str) -> PyResult<OnNone> {
    argument::choice("on_none", word, &[("center", OnNone::Center), ("drop", OnNone::Drop)])
}

/// What two crossings give.
pub fn on_two(word: &str) -> PyResult<OnTwo> {
    argument::choice("on_two", word, &[("drop", OnTwo::Drop), ("center", OnTwo::Center), ("mean", OnTwo::Mean)])
}

/// The kinds of an estimator's echoes to keep: a list of words, or one text with commas between them.
pub fn keep(value: Option<&Bound<'_, PyAny>>, estimator: &AnyEstimator) -> PyResult<Option<Vec<&'static str>>> {
    let Some(value) = value else { return Ok(None) };
    let words: Vec<String> = if value.is_instance_of::<PyString>() {
        value.extract::<String>()?.split(',').map(|word| word.trim().to_owned()).collect()
    } else {
        let wrong = |name: &str, item: &Bound<'_, PyAny>| {
            raise::kind(name, format_args!("expected kinds, found {}", argument::shown(item)))
        };
        let items = value.try_iter().map_err(|_| wrong("keep", value))?;
        let word = |(index, item): (usize, PyResult<Bound<'_, PyAny>>)| {
            let item = item?;
            item.extract().map_err(|_| wrong(&format!("keep[{index}]"), &item))
        };
        items.enumerate().map(word).collect::<PyResult<_>>()?
    };
    let kinds: Vec<(&str, &'static str)> = estimator.kinds().iter().map(|kind| (*kind, *kind)).collect();
    words.iter().map(|word| argument::choice("keep", word, &kinds)).collect::<PyResult<_>>().map(Some)
}

/// The rig's sensors, completed.
pub fn models(rig: &Rig, defaults: &Defaults) -> PyResult<Vec<SensorModel>> {
    defaults.complete(rig).map_err(|error| raise::library(&error))
}
