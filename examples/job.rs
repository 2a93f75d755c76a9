use marraztu::lab::job::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let get = |k: &str| a.iter().position(|x| x == k).map(|i| a[i + 1].clone());
    if get("--msaa").is_some_and(|m| m != "1") {
        std::process::exit(3);
    }
    let size = get("--size").unwrap_or("800x800".into());
    let (w, h) = size.split_once('x').unwrap();
    let mode = get("--mode").unwrap();
    let Some(m) = Mode::named(&mode) else { std::process::exit(3) };
    if let Some(t) = get("--threads") {
        rayon::ThreadPoolBuilder::new().num_threads(t.parse().unwrap()).build_global().unwrap();
    }
    let job = Job {
        mode: m,
        size: marraztu::base::image::Size::new(w.parse().unwrap(), h.parse().unwrap()),
        frames: get("--frames").map_or(200, |x| x.parse().unwrap()),
        warm_up: get("--warm").map_or(3, |x| x.parse().unwrap()),
        budget: get("--budget").map_or(600.0, |x| x.parse().unwrap()),
        distance: get("--dist").map_or(290.0, |x| x.parse().unwrap()),
        face: a.contains(&"--face".into()),
        raw: a.contains(&"--raw".into()),
    };
    let path = get("--mesh").unwrap();
    let loaded =
        marraztu::io::load(std::path::Path::new(&path), &Default::default(), &Default::default())
            .unwrap();
    let r = run(&job, &loaded.model).unwrap();
    let med = r.frames[r.frames.len() / 2];
    println!(
        "R,{},{},{},{},{},1,{},{:.4},{:.4},0,{:.4},{:.4},0,{}",
        get("--label").unwrap_or("marraztu".into()),
        path,
        r.triangles,
        mode,
        size,
        r.frames.len(),
        med,
        r.frames[0],
        med,
        r.frames[0],
        r.covered
    );
    if let Some(o) = get("--out") {
        let mut v = format!("P6\n{} {}\n255\n", job.size.width, job.size.height).into_bytes();
        for p in r.picture.pixels() {
            v.extend(&p[..3]);
        }
        std::fs::write(o, v).unwrap();
    }
}
