//! The identification alone, for an emulated Cortex-M4F (`bench/board/bits.py`): fingerprints and, by marks around each piece, instructions.
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
    use super::{TABLE, found};
    use firmware::fingerprint::{region, series};
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

    static mut SEARCH: Search = Search::new();

    /// One sample through every method, with a mark after each.
    #[inline(never)]
    fn pieces() -> Option<()> {
        let table = Table::parse(TABLE).ok()?;
        let slice = Slice::nearest(&table, 0.0, 0.0)?;
        let (series, region) = (series(&table, &slice)?, region(&table)?);
        // SAFETY: the only reference; nothing else runs.
        let search = unsafe { &mut *core::ptr::addr_of_mut!(SEARCH) };
        let mut profile = ProfileSearch::new(&table, &slice);
        let model = Indentation { surface: Surface::new(&table, &slice)? };
        let wide = |x: nalgebra::Vector2<f32>, d| Vector3::new(x[0], x[1], d);
        let wider = Region { low: wide(region.low, -0.1), high: wide(region.high, 0.1) };
        let mut two = Estimator::new(region.middle(), region, Bounding::Projection);
        let mut ours = Estimator::new(region.middle(), region, Bounding::Constrained { linearisations: 2 });
        let mut three = Estimator::new(wider.middle(), wider, Bounding::Constrained { linearisations: 1 });
        let reference = wider.middle();
        for (depth_mm, force_n) in series.take(50) {
            search.step(&table, &slice, depth_mm, force_n);
        }
        for (depth_mm, force_n) in series.skip(50).take(10) {
            tell(0);
            search.step(&table, &slice, depth_mm, force_n);
            tell(1);
            profile.step(&table, depth_mm, force_n);
            tell(2);
            two.step(&model, depth_mm, force_n, 1e-4);
            tell(3);
            ours.step(&model, depth_mm, force_n, 1e-4);
            tell(4);
            three.step_about(&model, &reference, depth_mm, force_n, 1e-4);
            tell(5);
            core::hint::black_box(search.found(&slice));
            tell(6);
            core::hint::black_box(profile.found(&table));
            tell(7);
            core::hint::black_box(search.error_n(&slice));
            tell(8);
        }
        core::hint::black_box((two, ours, three));
        Some(())
    }

    /// Entry: the emulator has set the stack and enabled the FPU. Ends with the mark 0xffffffff.
    #[unsafe(no_mangle)]
    pub extern "C" fn _start() -> ! {
        pieces();
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
