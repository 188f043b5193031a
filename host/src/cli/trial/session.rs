//! One session: present, wait for the key, write the answer down.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use miette::{IntoDiagnostic, miette};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::json;

use super::arguments::Run;
use super::present::{Keys, Presenter};
use crate::signals;
use crate::trial::journal::{Journal, Session};
use crate::trial::stiffness;
use crate::trial::weber::{References, answers};

/// Who answers.
enum Subject {
    /// Somebody at the keys.
    Keys(Keys),
    /// A simulated subject: probabilities of its answers, by what is shown.
    Simulated(Vec<Vec<f64>>, Pcg64Mcg),
}

/// Runs a session to its end, or to the end of the input.
pub(super) fn run(asked: &Run, materials: &[(String, Option<u8>)]) -> miette::Result<()> {
    let names: Vec<String> = materials.iter().map(|(name, _)| name.clone()).collect();
    let session = Session::new(names.clone(), asked.repeats, asked.seed, asked.subject);
    let mut subject = subject(asked, &names)?;
    // Before the board, so that a journal that is another's wakes no display.
    let mut journal = Journal::open(&asked.journal, &session)?;
    let mut presenter = match &asked.present {
        Some(address) if journal.next().is_some() => Presenter::open(address, asked.table.as_deref(), materials)?,
        _ => Presenter::Nobody,
    };
    let stop = Arc::new(AtomicBool::new(false));
    signals::stop_on_signals(&stop).into_diagnostic()?;
    begin(&journal, asked.present.is_none());
    let total = journal.session.order.len();
    while let Some((trial, shown)) = journal.next() {
        presenter.show(shown)?;
        let keys = names.iter().enumerate().map(|(at, name)| format!("{} {name}", at + 1)).collect::<Vec<_>>();
        errln!("{trial} of {total}. Press the display. Which is it?   {}", keys.join("   "));
        let began = Instant::now();
        let answered = match &mut subject {
            Subject::Simulated(rows, random) => Some(drawn(&rows[shown], random.random())),
            Subject::Keys(keys) => answer(&mut presenter, keys, names.len(), &stop)?,
        };
        presenter.hide()?;
        let Some(answered) = answered else { break };
        journal.answer(answered, began.elapsed().as_secs_f64())?;
    }
    drop(presenter);
    end(asked, &journal);
    Ok(())
}

fn begin(journal: &Journal, dry: bool) {
    let (session, done) = (&journal.session, journal.given.len());
    errln!("Subject {}, {} presentations.", session.subject, session.order.len());
    if dry {
        errln!("No board shows anything: --present BOARD.");
    }
    if journal.torn > 0 {
        errln!("The last line was not whole and is taken off: its presentation comes again.");
    }
    if done > 0 {
        errln!("{done} are answered already.");
    }
}

fn end(asked: &Run, journal: &Journal) {
    let (done, total) = (journal.given.len(), journal.session.order.len());
    let file = asked.journal.display();
    if asked.json {
        outln!(
            "{}",
            json!({ "journal": file.to_string(), "subject": journal.session.subject, "answered": done, "presentations": total })
        );
    } else if done == total {
        outln!("all {total} answered; palpate trial analyse {file}");
    } else {
        outln!("{done} of {total} answered and kept in {file}; the same command goes on");
    }
}

/// Keys, or a simulated subject that differs from session to session.
fn subject(asked: &Run, names: &[String]) -> miette::Result<Subject> {
    let Some(weber) = asked.simulate else { return Ok(Subject::Keys(Keys::new())) };
    let found = stiffness::of(names, &asked.stiffness, &[]);
    let values = names.iter().zip(found).map(|(name, found)| {
        let found = found
            .ok_or_else(|| miette!("--simulate: the stiffness of {name} is not known; --stiffness {name}=VALUE"))?;
        Ok(found.value)
    });
    let values = values.collect::<miette::Result<Vec<f64>>>()?;
    let seed = asked.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ u64::from(asked.subject);
    Ok(Subject::Simulated(answers(&values, weber, References::Touched), Pcg64Mcg::seed_from_u64(seed)))
}

/// The answer that a number of 0 to 1 draws.
fn drawn(row: &[f64], mut number: f64) -> usize {
    for (at, share) in row.iter().enumerate() {
        number -= share;
        if number < 0.0 {
            return at;
        }
    }
    row.len() - 1
}

/// Waits for a number of a material; none at q, at the end of the input, and when told to stop.
fn answer(presenter: &mut Presenter, keys: &Keys, count: usize, stop: &AtomicBool) -> miette::Result<Option<usize>> {
    while !stop.load(Ordering::Relaxed) {
        let Some(line) = presenter.turn(keys)? else { return Ok(None) };
        let Some(line) = line else { continue };
        match line.trim() {
            "q" => return Ok(None),
            text => match text.parse::<usize>() {
                Ok(number) if (1..=count).contains(&number) => return Ok(Some(number - 1)),
                _ => errln!("`{text}`: expected a number of 1 to {count}, or q to end"),
            },
        }
    }
    Ok(None)
}
