//! The conversation with the board, in a thread of its own: the picture never waits for the link.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use protocol::lut::Table;
use protocol::message::{DisplayMode, Hello, Mode, PalpationMode, Parts, Rule, Status};

use super::{OffSwitch, Recording};
use crate::link::{Link, LinkError};
use crate::log::{About, Freeze, LogError, frozen_text};
use crate::session::{Event, Patience, Session, SessionError, Traffic};

/// What a person asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Set the mode.
    Mode(Mode),
    /// Press, and display what is identified, now and from the verdict on.
    Both {
        /// Rate of the probe, mm/s.
        rate_mm_s: f32,
        /// Depth after contact, mm.
        depth_mm: f32,
    },
    /// Clear latched faults.
    ClearFaults,
    /// Take the load cell's reading as zero.
    Tare,
    /// Send the table and activate it.
    Upload,
    /// Begin (true) or end a recording.
    Record(bool),
    /// Outputs off, and end.
    Stop,
}

impl Command {
    /// It switches outputs on.
    fn switches_on(&self) -> bool {
        match self {
            Command::Mode(mode) => *mode != Mode::Idle,
            Command::Both { .. } => true,
            Command::ClearFaults | Command::Tare | Command::Upload | Command::Record(_) | Command::Stop => false,
        }
    }
}

/// What there is to show.
#[derive(Debug, Clone, PartialEq)]
pub enum Update {
    /// The link is being opened.
    Opening(String),
    /// A board has answered: the link's name, and who it is.
    Opened(String, Hello),
    /// The link is lost; it is tried again.
    Lost(String),
    /// What the board says of itself, several times a second.
    Status(Status),
    /// What the board said unasked, with the counters at that moment.
    Event(Event, Traffic),
    /// A command was carried out.
    Done(String),
    /// A command was refused, or failed.
    Refused(String),
    /// Outputs were switched off without being asked, and why.
    SwitchedOff(String),
    /// The file that is recorded to; `None` when a recording has ended.
    Recording(Option<PathBuf>),
    /// Bytes of the table sent, of so many.
    Upload(u32, u32),
}

/// Opens the link; called again when it is lost.
pub type Opener = Box<dyn FnMut() -> Result<Box<dyn Link>, LinkError> + Send>;

/// What the worker does besides talking.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The table to upload, checked.
    pub table: Option<Vec<u8>>,
    /// Upload it as soon as the board answers, if the board has another: for a simulated one, which begins without.
    pub upload_at_start: bool,
    /// Folder of recordings.
    pub folder: PathBuf,
    /// Between two attempts to open the link.
    pub retry: Duration,
    /// Set from outside, by a signal, it ends the conversation as [`Command::Stop`] does: also where whoever shows the picture waits for a terminal that takes no more of it.
    pub stop: Arc<AtomicBool>,
}

/// The thread, with its two ends. Dropping it switches the outputs off and waits for its end.
#[derive(Debug)]
pub struct Worker {
    commands: Sender<Order>,
    updates: Receiver<Update>,
    thread: Option<JoinHandle<()>>,
    off: OffSwitch,
    watched: Arc<Mutex<Instant>>,
}

/// A command, and how often the off switch had been pressed when it was asked for.
type Order = (u32, Command);

/// Longest wait for a record, s of link time: one tick, so that commands are not left lying.
const TURN_S: f64 = 0.02;

/// Silence after which the board is asked whether it is still there, s.
const SILENCE_S: f64 = 1.0;

/// Between two looks at the status, s.
const STATUS_S: f64 = 0.2;

/// Longest time that outputs stay on while nobody takes updates: the picture stands still, and so do the keys behind it.
const UNWATCHED: Duration = Duration::from_secs(1);

impl Worker {
    /// Opens the link by `opener` and talks to the board until told to stop.
    pub fn start(opener: Opener, settings: Settings) -> Self {
        let (commands, orders) = channel();
        let (reports, updates) = channel();
        let (off, watched) = (OffSwitch::default(), Arc::new(Mutex::new(Instant::now())));
        let mut conversation = Conversation {
            freeze: Freeze::new(&settings.folder),
            opener,
            settings,
            orders,
            reports,
            recording: None,
            opened_before: false,
            hello: None,
            off: off.clone(),
            offs_done: 0,
            watched: Arc::clone(&watched),
            unwatched: false,
        };
        let thread = std::thread::spawn(move || conversation.run());
        Worker { commands, updates, thread: Some(thread), off, watched }
    }

    /// A switch that turns outputs off whatever the one who watches is waiting for.
    pub fn off_switch(&self) -> OffSwitch {
        self.off.clone()
    }

    /// Gives a command; one to a worker that has ended is lost.
    pub fn command(&self, command: Command) {
        self.command_after(self.off.presses(), command);
    }

    /// Gives a command that was asked for when the off switch had been pressed `presses` times: a mode that was asked for before the
    /// last press is no longer wanted.
    pub fn command_after(&self, presses: u32, command: Command) {
        let _ = self.commands.send((presses, command));
    }

    /// The next update, waiting for at most `patience`; an error when the worker has ended. Outputs stay on only as long as this is
    /// called at least once a second.
    ///
    /// # Errors
    /// [`RecvTimeoutError::Disconnected`] when there will be none any more.
    pub fn update(&self, patience: Duration) -> Result<Option<Update>, RecvTimeoutError> {
        *self.watched.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
        match self.updates.recv_timeout(patience) {
            Ok(update) => Ok(Some(update)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(ended) => Err(ended),
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.command(Command::Stop);
        if let Some(thread) = self.thread.take() {
            // A panic in it has been printed by its own thread.
            let _ = thread.join();
        }
    }
}

/// Why a conversation has ended.
enum End {
    Stopped,
    Lost(String),
}

struct Conversation {
    opener: Opener,
    settings: Settings,
    orders: Receiver<Order>,
    reports: Sender<Update>,
    recording: Option<Recording>,
    freeze: Freeze,
    opened_before: bool,
    /// What the board said when the link was opened last.
    hello: Option<Hello>,
    off: OffSwitch,
    /// Presses of the off switch that were carried out.
    offs_done: u32,
    /// When the one who watches took updates last.
    watched: Arc<Mutex<Instant>>,
    /// Outputs were switched off because nobody took updates, and nobody has since.
    unwatched: bool,
}

/// Switches the outputs off when the conversation ends, also by a panic. Where the link is gone this fails, and the board does it by itself.
struct SafeEnd(Session<Box<dyn Link>>);

impl Drop for SafeEnd {
    fn drop(&mut self) {
        let _ = self.0.set_mode(Mode::Idle);
    }
}

impl Conversation {
    fn run(&mut self) {
        let mut board: Option<SafeEnd> = None;
        let mut why = String::new();
        loop {
            self.say(Update::Opening("opening".into()));
            let end = match (self.opener)().map_err(SessionError::from).and_then(|link| take_up(&mut board, link, &why))
            {
                Ok(hello) => match &mut board {
                    Some(board) => {
                        self.say(Update::Opened(board.0.link().name().to_owned(), hello.clone()));
                        let end = self.talk(board, hello);
                        if let End::Lost(reason) = &end {
                            why.clone_from(reason);
                            self.record_gap(reason);
                        }
                        end
                    }
                    None => End::Stopped,
                },
                Err(error) => End::Lost(error.to_string()),
            };
            match end {
                End::Stopped => break,
                End::Lost(reason) => self.say(Update::Lost(reason)),
            }
            if self.wait() {
                break;
            }
        }
        self.record(false);
    }

    fn tell_frozen(&self, frozen: Result<Option<PathBuf>, LogError>) {
        match frozen {
            Ok(Some(path)) => self.say(Update::Done(frozen_text(&path))),
            Ok(None) => {}
            Err(error) => self.say(Update::Refused(error.to_string())),
        }
    }

    fn record_gap(&mut self, reason: &str) {
        let frozen = self.freeze.lost();
        self.tell_frozen(frozen);
        if let Some(recording) = &mut self.recording
            && let Err(error) = recording.gap_begins(&format!("board lost: {reason}"))
        {
            self.give_up_recording(&error);
        }
    }

    /// Nobody may be left to listen; the commands tell.
    fn say(&self, update: Update) {
        let _ = self.reports.send(update);
    }

    /// Between two attempts; true when told to stop.
    fn wait(&mut self) -> bool {
        let until = Instant::now() + self.settings.retry;
        loop {
            match self.orders.recv_timeout(until.saturating_duration_since(Instant::now())) {
                Ok((_, Command::Stop)) | Err(RecvTimeoutError::Disconnected) => return true,
                Ok((_, Command::Record(on))) => self.record(on),
                Ok(_) => self.say(Update::Refused("no link to the board".into())),
                Err(RecvTimeoutError::Timeout) => break,
            }
        }
        if let Some(recording) = &mut self.recording
            && let Err(error) = recording.keep_if_due()
        {
            self.give_up_recording(&error);
        }
        self.is_over()
    }

    fn is_over(&self) -> bool {
        self.settings.stop.load(Ordering::Relaxed)
    }

    fn talk(&mut self, board: &mut SafeEnd, hello: Hello) -> End {
        let session = &mut board.0;
        self.offs_done = self.off.presses();
        // Whatever was going on when the link was lost, nobody has watched it since.
        if std::mem::replace(&mut self.opened_before, true)
            && let Err(error) = session.set_mode(Mode::Idle)
        {
            return End::Lost(error.to_string());
        }
        self.hello = Some(hello);
        // A recording that was begun without a link, or one whose board may have been exchanged.
        if let Err(error) = self.sign(session) {
            return End::Lost(error.to_string());
        }
        if self.settings.upload_at_start {
            self.settings.upload_at_start = false;
            if let Err(error) = self.carry_out(Command::Upload, session) {
                return End::Lost(error.to_string());
            }
        }
        let mut heard_s = session.link().now_s();
        let mut looked_s = f64::NEG_INFINITY;
        loop {
            if self.is_over() {
                return End::Stopped;
            }
            if let Err(error) = self.switch_off_if_asked(session) {
                return End::Lost(error.to_string());
            }
            match self.orders.try_recv() {
                Ok((_, Command::Stop)) | Err(std::sync::mpsc::TryRecvError::Disconnected) => return End::Stopped,
                // An off that came after it is carried out before it.
                Ok((presses, command)) if command.switches_on() && presses != self.off.presses() => {}
                Ok((_, command)) => {
                    if let Err(error) = self.carry_out(command, session) {
                        return End::Lost(error.to_string());
                    }
                }
                Err(std::sync::mpsc::TryRecvError::Empty) => {}
            }
            let now_s = session.link().now_s();
            match session.poll(now_s + TURN_S) {
                Ok(Some(event)) => {
                    heard_s = now_s;
                    self.keep(&event, session);
                    self.say(Update::Event(event, session.traffic()));
                }
                Ok(None) => {}
                Err(error) => return End::Lost(error.to_string()),
            }
            if session.link().now_s() - heard_s > SILENCE_S {
                match session.status() {
                    Ok(_) => heard_s = session.link().now_s(),
                    Err(error) => return End::Lost(error.to_string()),
                }
            }
            if now_s - looked_s >= STATUS_S
                && let Some(status) = session.latest_status()
            {
                looked_s = now_s;
                self.say(Update::Status(status.clone()));
            }
        }
    }

    /// Switches the outputs off when the switch was pressed, or when nobody has watched for [`UNWATCHED`].
    ///
    /// # Errors
    /// That of a link that is gone: the board's lease then ends, because nothing is sent until it is opened again.
    fn switch_off_if_asked(&mut self, session: &mut Session<Box<dyn Link>>) -> Result<(), SessionError> {
        let presses = self.off.presses();
        if std::mem::replace(&mut self.offs_done, presses) != presses {
            return self.carry_out(Command::Mode(Mode::Idle), session);
        }
        let stood_still = self.watched.lock().unwrap_or_else(PoisonError::into_inner).elapsed();
        let unwatched = stood_still > UNWATCHED;
        if !std::mem::replace(&mut self.unwatched, unwatched) && unwatched {
            // What was asked for before this is no longer wanted either.
            self.off.press();
            self.offs_done = self.off.presses();
            session.set_mode(Mode::Idle)?;
            self.say(Update::SwitchedOff("outputs off: the picture had stood still for a second".into()));
        }
        Ok(())
    }

    /// Does what was asked for. What the board refuses is told.
    ///
    /// # Errors
    /// That of a link that is gone.
    fn carry_out(&mut self, command: Command, session: &mut Session<Box<dyn Link>>) -> Result<(), SessionError> {
        let done = match command {
            Command::Mode(mode) => session.set_mode(mode).map(|()| mode_text(&mode)),
            Command::Both { rate_mm_s, depth_mm } => press_and_display(session, rate_mm_s, depth_mm),
            Command::ClearFaults => session.clear_faults().map(|()| "no fault is latched any more".to_owned()),
            Command::Tare => session.tare().map(|()| "the load cell's reading is its zero now".to_owned()),
            Command::Upload => self.upload(session),
            Command::Record(on) => {
                self.record(on);
                return self.sign(session);
            }
            // Seen by the caller.
            Command::Stop => return Ok(()),
        };
        match done {
            Ok(text) => self.say(Update::Done(text)),
            Err(error @ (SessionError::Link(_) | SessionError::NoAnswer { .. })) => return Err(error),
            Err(error) => self.say(Update::Refused(error.to_string())),
        }
        Ok(())
    }

    fn upload(&mut self, session: &mut Session<Box<dyn Link>>) -> Result<String, SessionError> {
        let Some(table) = self.settings.table.as_deref() else {
            return Ok("no table to upload".into());
        };
        let hash = Table::parse(table)?.hash();
        if session.has_table(&hash)? {
            return Ok("the board has this table already".into());
        }
        let reports = &self.reports;
        let uploaded = session.upload(table, |p| {
            let _ = reports.send(Update::Upload(p.sent, p.length));
        });
        let end = table.len() as u32;
        self.say(Update::Upload(end, end));
        let state = uploaded?;
        Ok(format!("table of {} bytes is active in slot {:?}", table.len(), state.active))
    }

    /// Writes into a running recording whose it is.
    fn sign(&mut self, session: &mut Session<Box<dyn Link>>) -> Result<(), SessionError> {
        let (Some(recording), Some(hello)) = (&mut self.recording, &self.hello) else { return Ok(()) };
        let about = About::of(session, hello)?;
        if let Err(error) = recording.about(&about) {
            self.give_up_recording(&error);
        }
        Ok(())
    }

    fn record(&mut self, on: bool) {
        let ended = self.recording.take().map(Recording::finish);
        if let Some(Err(error)) = &ended {
            self.say(Update::Refused(error.to_string()));
        }
        if ended.is_some() || !on {
            self.say(Update::Recording(None));
        }
        if on {
            match Recording::begin(&self.settings.folder) {
                Ok(recording) => {
                    self.say(Update::Recording(Some(recording.path().to_owned())));
                    self.recording = Some(recording);
                }
                Err(error) => self.say(Update::Refused(error.to_string())),
            }
        }
    }

    /// Logs; a disk that takes no more ends the recording, not the conversation.
    fn keep(&mut self, event: &Event, session: &mut Session<Box<dyn Link>>) {
        let frozen = self.freeze.event(event, &session.traffic());
        self.tell_frozen(frozen);
        let truths = session.link_mut().take_truth();
        let Some(recording) = &mut self.recording else {
            return;
        };
        let kept = truths.into_iter().try_for_each(|truth| recording.truth(truth));
        if let Err(error) = kept.and_then(|()| recording.event(event, &session.traffic())) {
            self.give_up_recording(&error);
        }
    }

    /// Ends a recording that cannot go on: what is complete in it stays.
    fn give_up_recording(&mut self, error: &LogError) {
        // The other of the two files may take its end; the first error is the one to tell.
        let _ = self.recording.take().map(Recording::finish);
        self.say(Update::Refused(error.to_string()));
        self.say(Update::Recording(None));
    }
}

/// Greets the board at `link`, or goes on with the conversation that was lost for the reason `why`.
fn take_up(board: &mut Option<SafeEnd>, link: Box<dyn Link>, why: &str) -> Result<Hello, SessionError> {
    if let Some(board) = board {
        return board.0.resume(link, why);
    }
    let (session, hello) = Session::open(link, Patience::default())?;
    *board = Some(SafeEnd(session));
    Ok(hello)
}

fn press_and_display(
    session: &mut Session<Box<dyn Link>>,
    rate_mm_s: f32,
    depth_mm: f32,
) -> Result<String, SessionError> {
    session.set_display(DisplayMode::Follow { parts: Parts::Both, by: Rule::Between })?;
    session.set_palpation(PalpationMode::Press { rate_mm_s, depth_mm, surface_mm: None })?;
    Ok(format!("palpating at {rate_mm_s:.1} mm/s, {depth_mm:.1} mm deep, and displaying what is identified"))
}

fn mode_text(mode: &Mode) -> String {
    match mode {
        Mode::Idle => "outputs off".into(),
        Mode::Palpate { rate_mm_s, depth_mm } => format!("palpating at {rate_mm_s:.1} mm/s, {depth_mm:.1} mm deep"),
        Mode::Display { material } => format!("displaying material {material}"),
    }
}
