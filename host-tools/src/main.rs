use host_tools::*; use host_tools::session::*; use host_tools::identify::*; use estimator_core::*; use clap::Parser;
#[derive(Parser)] struct C { #[command(flatten)] s: SearchOptions, #[command(flatten)] p: prepare::PrepareOptions }
fn main(){ let c=C::parse();
 let rig=rig::Rig::default();
 let logs: Vec<log::Log>=rig::EXCITATIONS.iter().map(|e|{let r=rig.record(*e); log::Log{name:e.name.into(),path:"".into(),sha256:"".into(),sample_period:1e-4,voltage:r.voltage,displacement:Some(r.displacement)}}).collect();
 let (va,tr):(Vec<_>,Vec<_>)=logs.into_iter().partition(|l|l.name=="tr10");
 let recipe=c.p.resolve(&tr);
 let ses=|l:&Vec<log::Log>|l.iter().map(|l|recipe.session(l).unwrap()).collect::<Vec<_>>();
 let pr=Problem::new(ses(&tr),ses(&va),Scheme::ForwardEuler,None,2.0);
 println!("{recipe:?} {:?}", pr.extent());
 let t=std::time::Instant::now();
 for f in identify(&pr,&Model::ALL,&c.s,&mut |_,_|()) { println!("{:?} {:?} cost {:.4} valid {:.4} {:?}", t.elapsed(), f.model,f.cost,f.convergence.last().unwrap().validation.unwrap(), pr.limits(&f.parameters)); for (g,v) in &f.genes { print!(" {}={:.4}",g.name,v);} println!(); }
}
