//! Which stimulus comes when.

use rand::seq::SliceRandom;
use rand::{RngCore, SeedableRng};
use rand_pcg::Pcg64Mcg;
use sha2::{Digest, Sha256};

/// Letters of a subject's code: none that is read as another.
const LETTERS: &[u8; 32] = b"ABCDEFGHJKLMNPQRSTUVWXYZ23456789";

/// Order of `repeats` presentations of each of `stimuli` materials: every block has each once, shuffled, so that a session that ends early is
/// still balanced. The same seed and subject give the same order on every machine.
#[must_use]
pub fn order(stimuli: usize, repeats: usize, seed: u64, subject: u32) -> Vec<usize> {
    let mut random = Pcg64Mcg::seed_from_u64(mixed(seed, subject, "order"));
    (0..repeats)
        .flat_map(|_| {
            let mut block: Vec<usize> = (0..stimuli).collect();
            block.shuffle(&mut random);
            block
        })
        .collect()
}

/// Code of a subject, `S-` and five letters. Who has the seed and the number can make it again; the code tells neither.
#[must_use]
pub fn code(seed: u64, subject: u32) -> String {
    let mut random = Pcg64Mcg::seed_from_u64(mixed(seed, subject, "code"));
    let letters: String = (0..5).map(|_| char::from(LETTERS[(random.next_u32() % 32) as usize])).collect();
    format!("S-{letters}")
}

/// A number that depends on all three and shows none of them.
fn mixed(seed: u64, subject: u32, purpose: &str) -> u64 {
    let digest = Sha256::digest(format!("palpate trial {purpose} {seed} {subject}"));
    digest.iter().take(8).fold(0, |all, byte| all << 8 | u64::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_has_each_once_and_seeds_differ() {
        let one = order(4, 25, 7, 1);
        assert!(one.chunks(4).all(|block| {
            let mut sorted = block.to_vec();
            sorted.sort_unstable();
            sorted == [0, 1, 2, 3]
        }));
        assert_eq!(one, order(4, 25, 7, 1));
        assert_ne!(one, order(4, 25, 7, 2));
        assert_ne!(one, order(4, 25, 8, 1));
        // Of 25 blocks each of four stimuli begins about six; none begins all or none (chance below 0.003).
        let begins = |s: usize| one.chunks(4).filter(|block| block[0] == s).count();
        assert!((0..4).all(|s| (1..=15).contains(&begins(s))));
    }

    #[test]
    fn a_code_tells_neither_seed_nor_number() {
        let codes: std::collections::BTreeSet<String> = (0..500).map(|subject| code(7, subject)).collect();
        // 32^5 codes: two of 500 are alike with a probability of 0.4 %.
        assert!(codes.len() >= 499 && codes.iter().all(|code| code.len() == 7));
        assert_eq!(code(7, 1), code(7, 1));
    }
}
