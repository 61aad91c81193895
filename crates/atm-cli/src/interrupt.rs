//! Ctrl-C and SIGTERM: a run ends early, and still as a run ends: what it has goes out, and it says where that is.
//!
//! The first signal is noted, and ends the wait for input; a second one ends the process at once. Where there are no such
//! signals, Ctrl-C ends the process as it ends any other.

use std::{fmt, io};

use atm::error::Error;

#[cfg(not(unix))]
pub use self::elsewhere::{caught, open};
#[cfg(unix)]
pub use self::unix::{caught, open};

/// The signal that ended a run, by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interrupted(i32);

impl Interrupted {
    /// The signal behind an error, if it is that.
    pub fn of(error: &Error) -> Option<Self> {
        match error {
            Error::Interrupted => caught(),
            Error::Io { source, .. } => source.get_ref()?.downcast_ref().copied(),
            _ => None,
        }
    }

    /// Ends the process as the signal would have ended it, so that whoever waits for it can tell; the exit status where
    /// that does not work.
    pub fn end(self) -> u8 {
        #[cfg(unix)]
        let _ = signal_hook::low_level::emulate_default_handler(self.0);
        u8::try_from(128_i32.saturating_add(self.0)).unwrap_or(1)
    }
}

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        #[cfg(unix)]
        if let Some(name) = signal_hook::low_level::signal_name(self.0) {
            return write!(f, "ended by {name}");
        }
        write!(f, "ended by signal {}", self.0)
    }
}

impl std::error::Error for Interrupted {}

impl From<Interrupted> for io::Error {
    fn from(interrupted: Interrupted) -> Self {
        // Not `ErrorKind::Interrupted`: readers take that as a reason to try again.
        Self::other(interrupted)
    }
}

#[cfg(unix)]
mod unix {
    use std::{
        fs::{self, File},
        io::{self, Read},
        os::{fd::AsFd, unix::net::UnixStream},
        sync::{
            OnceLock,
            atomic::{AtomicBool, AtomicUsize, Ordering},
        },
    };

    use atm::{
        error::{Error, Result},
        log::Input,
    };
    use rustix::event::{PollFd, PollFlags, poll};
    use signal_hook::{
        consts::{SIGINT, SIGTERM},
        flag, low_level,
    };

    use super::Interrupted;

    const SIGNALS: [i32; 2] = [SIGINT, SIGTERM];

    /// Whether a signal has come, and the number of the latest; 0 before.
    static CAUGHT: AtomicBool = AtomicBool::new(false);
    static SIGNAL: AtomicUsize = AtomicUsize::new(0);
    /// A byte comes in with each signal.
    static WOKEN: OnceLock<io::Result<UnixStream>> = OnceLock::new();

    /// The signal that has come, if one has.
    pub fn caught() -> Option<Interrupted> {
        match i32::try_from(SIGNAL.load(Ordering::Relaxed)) {
            Ok(signal @ 1..) => Some(Interrupted(signal)),
            _ => None,
        }
    }

    /// As [`Input::open`]; from here on the first signal is noted, and ends the wait for what comes through a pipe or a device.
    pub fn open(path: &str) -> Result<Input> {
        let failed = |source| Error::Io { file: path.into(), source };
        if path == "-" {
            // Not `Stdin`, which buffers: nobody could tell whether to wait.
            let standard = File::from(io::stdin().as_fd().try_clone_to_owned().map_err(failed)?);
            let reader = Box::new(Guarded { reader: standard, woken: watch().map_err(failed)? });
            return Ok(Input { reader, ..Input::open(path)? });
        }
        if fs::metadata(path).is_ok_and(|metadata| metadata.is_file() || metadata.is_dir()) {
            watch().map_err(failed)?;
            return Input::open(path);
        }
        // A pipe is waited for here, and Ctrl-C ends that as it ends any process.
        let file = File::open(path).map_err(failed)?;
        let reader = Box::new(Guarded { reader: file, woken: watch().map_err(failed)? });
        Ok(Input { reader, name: path.into(), length: None })
    }

    /// Takes the signals over, once.
    fn watch() -> io::Result<&'static UnixStream> {
        WOKEN.get_or_init(take_over).as_ref().map_err(|error| error.kind().into())
    }

    /// What the process was told to ignore (`nohup`, a script's job in the background) it ignores on.
    fn take_over() -> io::Result<UnixStream> {
        let (woken, wake) = UnixStream::pair()?;
        let ignored = ignored();
        for signal in SIGNALS.into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0) {
            // In this order: the first signal finds the condition not yet met.
            flag::register_conditional_default(signal, &CAUGHT)?;
            flag::register(signal, &CAUGHT)?;
            flag::register_usize(signal, &SIGNAL, usize::try_from(signal).unwrap_or_default())?;
            low_level::pipe::register(signal, wake.try_clone()?)?;
        }
        Ok(woken)
    }

    /// The signals that are ignored, as bits from the first; none where the system does not say.
    fn ignored() -> u64 {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        line.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok()).unwrap_or_default()
    }

    /// A reader whose wait a signal ends.
    struct Guarded {
        reader: File,
        woken: &'static UnixStream,
    }

    impl Read for Guarded {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            loop {
                if let Some(interrupted) = caught() {
                    return Err(interrupted.into());
                }
                let mut waits = [PollFd::new(&self.reader, PollFlags::IN), PollFd::new(self.woken, PollFlags::IN)];
                match poll(&mut waits, None) {
                    // An end or an error of the input is for the read to find out.
                    Ok(_) if !waits[0].revents().is_empty() => return self.reader.read(buffer),
                    Ok(_) | Err(rustix::io::Errno::INTR) => {}
                    Err(error) => return Err(error.into()),
                }
            }
        }
    }
}

#[cfg(not(unix))]
mod elsewhere {
    use atm::{error::Result, log::Input};

    use super::Interrupted;

    /// None: they are not watched for.
    pub fn caught() -> Option<Interrupted> {
        None
    }

    /// As [`Input::open`].
    pub fn open(path: &str) -> Result<Input> {
        Input::open(path)
    }
}
