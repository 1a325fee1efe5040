#![no_main]
caustica_fuzz::target!("vol");
