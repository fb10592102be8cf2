use enfilade::cells::*; use enfilade::level::*; use enfilade::pvs::*; use std::time::Instant;
fn main(){
  let args: Vec<String>=std::env::args().collect();
  let limit: u64 = args[2].parse().unwrap();
  rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
  let bytes=std::fs::read(&args[1]).unwrap();
  let wad=wad::Wad::parse(bytes).unwrap();
  let maps: Vec<String> = if args.len()>3 { args[3..].to_vec() } else { wad.maps().iter().map(|m| m.name.to_string()).collect() };
  for m in maps {
    let t=Instant::now();
    let d=doom::read_map(&wad,&m,"x.wad").unwrap();
    let level=snap::snap(d).unwrap();
    let tr=t.elapsed().as_secs_f64();
    for s in Subdivision::ALL {
      let t=Instant::now();
      let g=subdivide(&level,&Options{subdivision:s,..Default::default()});
      let ts=t.elapsed().as_secs_f64();
      if let Err(f)=g.validate(){ println!("{m} {} INVALID {f}",s.as_str()); }
      let t=Instant::now();
      let p=sweep::sweep(&g,&Progress::default());
      let tp=t.elapsed().as_secs_f64();
      if let Err(f)=p.validate(&g){ println!("{m} {} PVS INVALID {f}",s.as_str()); }
      let t=Instant::now();
      for _ in 0..20 { sweep::sweep(&g,&Progress::default()); } let q=search::search(&g,Some(limit),&Progress::default());
      let tq=t.elapsed().as_secs_f64();
      if let Some(q)=&q { let mut k=0; for a in g.cell_ids(){ for b in g.cell_ids(){ if a<b && p.sees(a,b)!=q.sees(a,b) && k<2 { k+=1; let show=|c|{ g.corners(c).map(|v|format!("{:?}",g.vertices.approx(v).to_array())).collect::<Vec<_>>().join(" ")}; println!("  {:?} {:?} sweep {} search {} / {}\n A {}\n B {}",a,b,p.sees(a,b),q.sees(a,b),q.sees(b,a),show(a),show(b)); }}} }
      let pairs=p.pairs();
      let (sr,ss)=match &q {Some(q)=>(if q.visible==p.visible {"agree".into()} else {format!("DIFFER {}",q.pairs())},q.steps),None=>("-".into(),0)};
      let area: f64=g.cell_ids().map(|c|g.area(c)).sum();
      println!("{m:6} {:3} walls {:5} cells {:5} portals {:5} splits {:5} depth {:3} fb {} area {area} read {:.1}ms sub {:.1}ms sweep {:.1}ms ({} steps) pairs {pairs} {:.1} ns/pair search {:.1}ms {:.1} ns/pair steps {ss} ({:.1}/pair) {sr}",
       s.as_str(),level.walls.len(),g.cells.len(),g.portals.len(),g.cost.wall_splits,g.cost.depth,g.cost.fallback,tr*1e3,ts*1e3,tp*1e3,p.steps,tp*1e9/pairs as f64,tq*1e3,tq*1e9/pairs as f64, ss as f64/pairs as f64);
    }
  }
}
