#![allow(missing_docs, clippy::unwrap_used)]
use lut_gen::{contact::*, law::*, model::*, solve::*};
fn main() {
    let res = match std::env::args().nth(1).as_deref() { Some("fine") => Resolution::Fine, Some(x) => Resolution::Refined(x.parse().unwrap()), None => Resolution::Standard };
    let dir = "/work/shared/reference/";
    for e in ["alpha1_r4","alpha4_r4","alpha24_r4","nu02_r4","thin5_r4","two_terms_r4","icf_r4_bonded","eva_r6_bonded","b1_r6_sliding","ccx_EVA_R4","ccx_B1_R4","ccx_ICF_R4"] {
        let text = std::fs::read_to_string(format!("{dir}{e}.csv")).unwrap();
        let get = |k: &str| text.lines().nth(1).unwrap().trim_start_matches("# ").split(['[',' ',',']).filter_map(|t| t.split_once('=')).find(|(a,_)| *a==k).map(|(_,v)| v.parse::<f64>().unwrap());
        let (mut terms, mut h, mut r, mut base) = (vec![], 12.7, 4.0, Base::Bonded);
        match e {
            "ccx_EVA_R4" => { terms.push(Term{mu_mpa:0.22,alpha:10.526,nu:0.0}); base = Base::Sliding; }
            "ccx_B1_R4" => { terms.push(Term{mu_mpa:0.193,alpha:12.711,nu:0.0}); base = Base::Sliding; h=19.05; }
            "ccx_ICF_R4" => { terms.push(Term{mu_mpa:0.0137,alpha:14.8,nu:0.0}); base = Base::Sliding; h=25.4; }
            _ => {
                terms.push(Term{mu_mpa:get("mu").unwrap(),alpha:get("alpha").unwrap(),nu:get("nu").unwrap_or(0.0)});
                if let Some(m) = get("mu2") { terms.push(Term{mu_mpa:m,alpha:get("alpha2").unwrap(),nu:0.0}); }
                h = get("h").unwrap(); r = get("R").unwrap();
                if get("sliding").is_some() { base = Base::Sliding; }
            }
        }
        let rows: Vec<(f64,f64)> = text.lines().filter_map(|l| { let (a,b)=l.split_once(',')?; Some((a.parse().ok()?, b.parse().ok()?)) }).collect();
        let i = Indentation { law: Hyperfoam::new(terms).unwrap(), specimen: Specimen{height_mm:h,radius_mm:25.0,base}, ball: Ball{radius_mm:r}, depth_mm:4.0, resolution: res };
        let c = i.solve().unwrap();
        let unc: String = text.lines().filter(|l| l.contains("uncertainty")).map(|l| l.split(':').next_back().unwrap().split('(').next().unwrap().trim().chars().take(60).collect::<String>()).collect();
        print!("{e:14} n={} it={} steps={} cuts={} {:.2}s imb {:.0e} disc {:.2}% |", c.stats.unknowns, c.stats.iterations, c.stats.steps, c.stats.cuts, c.stats.seconds, c.stats.imbalance, 100.0*c.discretisation);
        for d in [0.1,0.25,0.5,1.0,1.5,2.0,2.5,3.0,4.0] {
            let k = rows.iter().position(|x| (x.0-d).abs()<1e-6);
            if let Some(k) = k { print!(" {:+.2}", 100.0*(c.profile.force_n(d)/rows[k].1-1.0)); } else { print!("   -  "); }
        }
        println!(" | {unc}");
    }
}
