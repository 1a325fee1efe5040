#![no_main]
caustica_fuzz::target!("render_mitsuba");
