//! The identification alone, for an emulated Cortex-M4F (`tests/emulator`): fingerprints and, by marks around each piece, instructions.
//! On the host it only prints the fingerprints.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![cfg_attr(target_os = "none", allow(unsafe_code))]

use firmware::fingerprint::{Fingerprint, fingerprint};
use protocol::lut::Table;

const TABLE: &[u8] = include_bytes!("../../tests/golden/fingerprint.lut");

fn found() -> Option<Fingerprint> {
    fingerprint(&Table::parse(TABLE).ok()?)
}

#[cfg(not(target_os = "none"))]
fn main() {
    match found() {
        Some(f) => println!(
            "search {:016x}\nprofile {:016x}\nfilter {:016x}\noffset filter {:016x}",
            f.search, f.profile, f.filter, f.offset_filter
        ),
        None => eprintln!("the table has no fingerprint"),
    }
}

#[cfg(target_os = "none")]
mod emulated {
    use super::found;
    use firmware::fingerprint::{region, series};
    use firmware::flash::SLOT_LEN;
    use firmware::kalman::indentation::Indentation;
    use firmware::kalman::{Bounding, Estimator, Region};
    use firmware::profile::ProfileSearch;
    use firmware::search::{Search, Slice};
    use firmware::surface::Surface;
    use nalgebra::Vector3;
    use protocol::lut::Table;

    /// Address that the emulator watches.
    const PORT: *mut u32 = 0x4000_0000 as *mut u32;

    /// Tells the emulator a number.
    fn tell(number: u32) {
        // SAFETY: the emulator maps this address; nothing else runs this program.
        unsafe { PORT.write_volatile(number) }
    }

    /// Mark after the counted pieces.
    const END_OF_PIECES: u32 = 0xffff_fffe;

    /// Where the emulator puts the tables that are measured: the slots of flash bank 2, with the marks of their pieces. Without a table there, nothing is.
    const SLOTS: [(usize, u32); 2] = [(0x0810_0000, 0x100), (0x0810_0000 + SLOT_LEN, 0x200)];

    static mut SEARCH: Search = Search::new();

    /// The pieces over each table that is there.
    fn measure() {
        for (address, first) in SLOTS {
            // SAFETY: the emulator maps both slots, and nothing writes to them.
            let slot = unsafe { core::slice::from_raw_parts(address as *const u8, SLOT_LEN) };
            if let Ok(table) = Table::parse(slot) {
                pieces(&table, first);
            }
        }
    }

    /// One sample through every method, with a mark after each, counted from `first`.
    #[inline(never)]
    fn pieces(table: &Table<'_>, first: u32) -> Option<()> {
        let slice = Slice::nearest(table, 0.0, 0.0)?;
        let (series, region) = (series(table, &slice)?, region(table)?);
        // SAFETY: the only reference; nothing else runs.
        let search = unsafe { &mut *core::ptr::addr_of_mut!(SEARCH) };
        search.reset();
        let mut profile = ProfileSearch::new(table, &slice);
        let model = Indentation { surface: Surface::new(table, &slice)? };
        let wide = |x: nalgebra::Vector2<f32>, d| Vector3::new(x[0], x[1], d);
        let wider = Region { low: wide(region.low, -0.1), high: wide(region.high, 0.1) };
        let mut two = Estimator::new(region.middle(), region, Bounding::Projection);
        let mut ours = Estimator::new(region.middle(), region, Bounding::Constrained { linearisations: 2 });
        let mut three = Estimator::new(wider.middle(), wider, Bounding::Constrained { linearisations: 1 });
        let reference = wider.middle();
        for (depth_mm, force_n) in series.take(50) {
            search.step(table, &slice, depth_mm, force_n);
        }
        for (depth_mm, force_n) in series.skip(50).take(10) {
            tell(first);
            search.step(table, &slice, depth_mm, force_n);
            tell(first + 1);
            profile.step(table, depth_mm, force_n);
            tell(first + 2);
            two.step(&model, depth_mm, force_n, 1e-4);
            tell(first + 3);
            ours.step(&model, depth_mm, force_n, 1e-4);
            tell(first + 4);
            three.step_about(&model, &reference, depth_mm, force_n, 1e-4);
            tell(first + 5);
            core::hint::black_box(search.found(&slice));
            tell(first + 6);
            core::hint::black_box(profile.found(table));
            tell(first + 7);
            core::hint::black_box(search.error_n(&slice));
            tell(first + 8);
        }
        core::hint::black_box((two, ours, three));
        Some(())
    }

    /// Entry: the emulator has set the stack and enabled the FPU. Ends with the mark 0xffffffff.
    #[unsafe(no_mangle)]
    pub extern "C" fn _start() -> ! {
        measure();
        tell(END_OF_PIECES);
        if let Some(f) = found() {
            for hash in [f.search, f.profile, f.filter, f.offset_filter] {
                tell(hash as u32);
                tell((hash >> 32) as u32);
            }
        }
        tell(u32::MAX);
        loop {
            core::hint::spin_loop();
        }
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        tell(u32::MAX);
        loop {
            core::hint::spin_loop();
        }
    }
}
