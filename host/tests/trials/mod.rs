//! Seeded trials of `palpate log` against `palpate board serve`: restarts, a pulled cable, signals, a full disk.

pub mod check;
pub mod line;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use line::Line;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// The program under test.
pub const PALPATE: &str = env!("CARGO_BIN_EXE_palpate");

/// Longest wait for anything: the machine may be busy with other things.
const LONGEST: Duration = Duration::from_secs(60);

/// What happens on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Disturbance {
    /// The board restarts while the line stays open.
    Restart,
    /// The cable is out for this time.
    Unplugged(Duration),
    /// Both at once.
    RestartUnplugged(Duration),
}

/// How it ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum End {
    Kill,
    Term,
    Interrupt,
    HangUp,
    DiskFull,
    Gone,
}

/// A child that does not outlive its trial.
struct Owned(Child);

impl Drop for Owned {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn board(port: u16) -> Result<(Owned, u16), String> {
    let started = Instant::now();
    loop {
        let mut child = Owned(
            Command::new(PALPATE)
                .args(["board", "serve", "--listen", &format!("127.0.0.1:{port}")])
                .stdout(Stdio::piped())
                .stderr(Stdio::null())
                .spawn()
                .map_err(|e| format!("{PALPATE}: {e}"))?,
        );
        let mut first = String::new();
        let output = child.0.stdout.take().ok_or("no output")?;
        BufReader::new(output).read_line(&mut first).map_err(|e| e.to_string())?;
        match first.trim().rsplit(':').next().and_then(|port| port.parse().ok()) {
            Some(port) => return Ok((child, port)),
            // The port of the board before is not free yet.
            None if started.elapsed() < LONGEST => thread::sleep(Duration::from_millis(50)),
            None => return Err(format!("the board does not listen: {first}")),
        }
    }
}

fn until<T>(what: &str, mut found: impl FnMut() -> Option<T>) -> Result<T, String> {
    let started = Instant::now();
    loop {
        if let Some(found) = found() {
            return Ok(found);
        }
        if started.elapsed() > LONGEST {
            return Err(format!("within {LONGEST:?} not: {what}"));
        }
        thread::sleep(Duration::from_millis(10));
    }
}

fn length(path: &Path) -> u64 {
    path.metadata().map_or(0, |found| found.len())
}

/// A trial under way.
struct Trial {
    folder: PathBuf,
    csv: PathBuf,
    mcap: PathBuf,
    line: Line,
    board: Option<Owned>,
    port: u16,
    log: Owned,
    /// What the files held at some moments: bytes of the CSV up to a whole line, messages of the MCAP.
    seen: Vec<(Vec<u8>, usize)>,
}

impl Trial {
    /// Starts board, line and log; in half of the trials a recording of that name exists already.
    fn begin(folder: &Path, end: End, random: &mut Pcg64) -> Result<Self, String> {
        let (board, port) = board(0)?;
        let line = Line::to(port).map_err(|e| e.to_string())?;
        let exists = random.random_bool(0.5);
        if exists {
            std::fs::write(folder.join("rec.csv"), MINE).map_err(|e| e.to_string())?;
        }
        let suffix = if exists { "-2" } else { "" };
        // Blocks of 512 bytes: MCAP grows by some 20 KB a second, and is the first to be full.
        let limit = if end == End::DiskFull { random.random_range(40..160).to_string() } else { "unlimited".into() };
        let retry = if end == End::Gone { "4" } else { "60" };
        let mut command = Command::new("sh");
        command.arg("-c").arg(format!("ulimit -f {limit}; exec \"$0\" \"$@\"")).arg(PALPATE);
        command.args(["log", "--csv", "rec.csv", "--mcap", "rec.mcap", "--retry", retry, "--board"]);
        command.arg(format!("tcp:127.0.0.1:{}", line.port)).current_dir(folder).stdin(Stdio::null());
        let told = File::create(folder.join("told.txt")).map_err(|e| e.to_string())?;
        command.stdout(Stdio::null()).stderr(told);
        let log = Owned(command.spawn().map_err(|e| e.to_string())?);
        let (csv, mcap) = (folder.join(format!("rec{suffix}.csv")), folder.join(format!("rec{suffix}.mcap")));
        let trial = Trial { folder: folder.into(), csv, mcap, line, board: Some(board), port, log, seen: Vec::new() };
        until("the log begins", || (length(&trial.csv) > 1000).then_some(()))?;
        Ok(trial)
    }

    fn told(&self) -> String {
        std::fs::read_to_string(self.folder.join("told.txt")).unwrap_or_default()
    }

    fn gaps_told(&self) -> usize {
        // Before the summary at the end, which repeats them.
        self.told().split("recorded   ").next().map_or(0, |text| text.matches("gap of ").count())
    }

    /// Remembers what is in the files now.
    fn look(&mut self) {
        let bytes = std::fs::read(&self.csv).unwrap_or_default();
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        let messages = check::messages(&self.mcap).map_or(0, |(messages, ..)| messages.len());
        self.seen.push((bytes[..whole].to_vec(), messages));
    }

    fn restart(&mut self) -> Result<(), String> {
        self.board = None;
        self.board = Some(board(self.port)?.0);
        Ok(())
    }

    /// Does it, and waits until records come again.
    fn disturb(&mut self, disturbance: Disturbance) -> Result<(), String> {
        let told = self.gaps_told();
        match disturbance {
            Disturbance::Restart => self.restart()?,
            Disturbance::Unplugged(time) => {
                self.line.pull(true);
                thread::sleep(time);
                self.line.pull(false);
            }
            Disturbance::RestartUnplugged(time) => {
                self.line.pull(true);
                self.restart()?;
                thread::sleep(time);
                self.line.pull(false);
            }
        }
        until("the gap is told", || (self.gaps_told() > told).then_some(()))?;
        let before = length(&self.csv);
        until("records come again", || (length(&self.csv) > before + 500).then_some(()))
    }

    fn signal(&self, name: &str) {
        let _ = Command::new("kill").arg(format!("-{name}")).arg(self.log.0.id().to_string()).status();
    }

    fn end(&mut self, end: End) -> Result<ExitStatus, String> {
        match end {
            End::Kill => self.signal("KILL"),
            End::Term => self.signal("TERM"),
            End::Interrupt => self.signal("INT"),
            // Under nohup the log rightly goes on.
            End::HangUp => self.signal(if hang_up_is_ignored() { "TERM" } else { "HUP" }),
            End::DiskFull => {}
            End::Gone => self.line.pull(true),
        }
        let log = &mut self.log.0;
        until("the log ends", || log.try_wait().ok().flatten())
    }
}

const MINE: &str = "time_s,force_N\n0,0\n";

fn disturbance(random: &mut Pcg64) -> Disturbance {
    let time = Duration::from_millis(random.random_range(20..1200));
    match random.random_range(0..3) {
        0 => Disturbance::Restart,
        1 => Disturbance::Unplugged(time),
        _ => Disturbance::RestartUnplugged(time),
    }
}

/// True where this process, and what it starts, ignores SIGHUP: the lowest bit of the mask that Linux tells.
fn hang_up_is_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}

/// One trial; what it was, or what is wrong.
pub fn trial(seed: u64) -> Result<(End, usize), String> {
    let random = &mut Pcg64::seed_from_u64(seed);
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let end = [End::Kill, End::Term, End::Interrupt, End::HangUp, End::DiskFull, End::Gone][random.random_range(0..6)];
    let mut trial = Trial::begin(folder.path(), end, random)?;
    let mut done = Vec::new();
    // A disk that is full soon leaves no time for anything else.
    let disturbances = if end == End::DiskFull { 0 } else { random.random_range(0..4) };
    for _ in 0..disturbances {
        thread::sleep(Duration::from_millis(random.random_range(0..800)));
        trial.look();
        let one = disturbance(random);
        trial.disturb(one).map_err(|e| format!("{one:?}: {e}\n{}", trial.told()))?;
        done.push(one);
    }
    thread::sleep(Duration::from_millis(random.random_range(0..1500)));
    trial.look();
    let ended = SystemTime::now();
    let status = trial.end(end)?;
    judge(&trial, end, &done, status, ended).map_err(|e| format!("{end:?} after {done:?}: {e}\n{}", trial.told()))?;
    Ok((end, done.len()))
}

fn demand(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}

fn judge(trial: &Trial, end: End, done: &[Disturbance], status: ExitStatus, ended: SystemTime) -> Result<(), String> {
    let mine = trial.folder.join("rec.csv");
    demand(mine == trial.csv || std::fs::read_to_string(&mine).is_ok_and(|text| text == MINE), || {
        "the recording that existed has changed".into()
    })?;
    let rows = check::rows(&trial.csv)?;
    let notes = check::gaps_are_told(&rows)?;
    let (messages, proper, gaps) = check::messages(&trial.mcap)?;
    let bytes = std::fs::read(&trial.csv).map_err(|e| e.to_string())?;
    for (csv, count) in &trial.seen {
        demand(bytes.starts_with(csv), || format!("{} bytes of the CSV that were there are not any more", csv.len()))?;
        demand(messages.len() >= *count, || format!("of {count} messages {} are left", messages.len()))?;
    }
    // A gap is told where a row follows it.
    demand(notes.len() == done.len() && gaps == done.len() && trial.gaps_told() == done.len(), || {
        format!(
            "{} gaps, told {} in the CSV, {gaps} in the MCAP, {} on the terminal",
            done.len(),
            notes.len(),
            trial.gaps_told()
        )
    })?;
    for (one, note) in done.iter().zip(&notes) {
        let restarted = !matches!(one, Disturbance::Unplugged(_));
        demand(!restarted || note.contains("restarted (cause: power on"), || format!("{one:?} is told as {note}"))?;
        let lost = *one != Disturbance::Restart;
        demand(!lost || note.contains("link lost"), || format!("{one:?} is told as {note}"))?;
    }
    // Errors are wrapped to the width of the terminal.
    let told: Vec<String> = trial.told().split_whitespace().filter(|word| *word != "│").map(str::to_owned).collect();
    let (code, told) = (status.code(), told.join(" "));
    match end {
        End::Kill => {
            let written = trial.csv.metadata().and_then(|found| found.modified()).map_err(|e| e.to_string())?;
            let lost = ended.duration_since(written).unwrap_or_default();
            demand(lost < Duration::from_secs(3), || format!("nothing was written for {lost:?} before the kill"))
        }
        End::Term | End::Interrupt | End::HangUp => {
            demand(code == Some(0) && proper, || format!("exit {code:?}, MCAP ended properly: {proper}"))
        }
        End::DiskFull => {
            let named = told.contains("recording rec") && told.contains("what was recorded before is kept");
            demand(code == Some(2) && named, || format!("exit {code:?}"))
        }
        End::Gone => {
            let named = told.contains("not heard again within 4 s") && told.contains("--retry");
            demand(code == Some(2) && proper && named, || format!("exit {code:?}, MCAP ended properly: {proper}"))
        }
    }
}
