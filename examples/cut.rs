use decks::mesh::Mesh;
use feti_contact::solver::{Problem, RowKind};
#[path = "../tests/mesh/bodies.rs"]
mod bodies;
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    (f[11].parse::<f64>().unwrap() + f[12].parse::<f64>().unwrap()) / 100.0
}
fn hwm() -> String {
    std::fs::read_to_string("/proc/self/status")
        .unwrap()
        .lines()
        .find(|l| l.starts_with("VmHWM"))
        .unwrap()
        .to_string()
}
fn main() {
    let args: Vec<i64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let (n, pieces, threads) = (args[0] as usize, args[1], args[2]);
    let mut random = decks::random::Random::new(3);
    let mut block = |low: f64, e: f64| {
        let mut mesh = Mesh::grid([n; 3], |[x, y, z]| [x, y, z + low]);
        mesh.young.iter_mut().for_each(|young| *young = e * (1.0 + 1e-3 * random.between(0.0, 1.0)));
        mesh
    };
    let model = bodies::Model::stacked(block(0.0, 1.0), block(1.0, 2.0), |at| at[2] == 0.0);
    let t = std::time::Instant::now();
    let c0 = cpu();
    let mut problem: Problem = model.by_elements(pieces, true).unwrap();
    println!("assembly {:.2} cpu {:.2} {}", t.elapsed().as_secs_f64(), cpu() - c0, hwm());
    problem.set_i64("threads", threads).unwrap();
    if let Ok(options) = std::env::var("OPT") {
        problem.set_text(&options).unwrap();
    }
    for step in 0..2 {
        let (t, c0) = (std::time::Instant::now(), cpu());
        let report = problem.solve().unwrap();
        println!("step {step} wall {:.2} cpu {:.2} {:?} products {} steps {} coarse {} energy {:.12e} worst {:.2e} pieces {:?} {}", t.elapsed().as_secs_f64(), cpu() - c0, report.outcome, report.counts.products, report.counts.steps(), report.counts.coarse_solves, report.energy, report.certificate.worst(), problem.body_facts(0).unwrap().pieces, hwm());
        for p in &report.phases {
            println!("   {p:?}");
        }
        for body in 0..2 {
            let f: Vec<f64> = model.loads[body].iter().map(|f| 1.1 * f).collect();
            problem.set_load(body, &f).unwrap();
        }
        let gaps: Vec<f64> = model.rows.iter().map(|r| 0.9 * r.1).collect();
        problem.set_rhs(RowKind::Inequality, 0, &gaps).unwrap();
    }
}
