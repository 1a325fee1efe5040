//! A Slurm of one machine: munge, controller and node daemon, in a folder of their own, for the time of a test.

use std::fs;
use std::net::TcpListener;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const DAEMONS: [&str; 3] = ["munged", "slurmctld", "slurmd"];
const INSTALL: &str = "no Slurm; install it with: apt-get install slurm-wlm munge";

/// How long the daemons may take to start, and a command of theirs to answer.
const PATIENCE: Duration = Duration::from_secs(30);

/// Ended, with all that was started, when it is dropped.
pub struct Cluster {
    folder: tempfile::TempDir,
    daemons: Vec<Child>,
}

/// A job, or one task of an array.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Job {
    pub number: String,
    /// Of the array, if it is one of those.
    pub task: Option<u32>,
    pub state: String,
}

fn found(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    // Daemons are not on everybody's PATH.
    let folders = std::env::split_paths(&path).chain(["/usr/sbin".into(), "/usr/local/sbin".into()]);
    folders.map(|folder| folder.join(program)).find(|file| file.is_file())
}

fn free_port() -> Result<u16, String> {
    let listener = TcpListener::bind("127.0.0.1:0").map_err(|e| format!("no port is free: {e}"))?;
    Ok(listener.local_addr().map_err(|e| e.to_string())?.port())
}

impl Cluster {
    /// Starts the daemons, or says why that cannot be.
    pub fn start() -> Result<Self, String> {
        let programs: Option<Vec<PathBuf>> = DAEMONS.into_iter().map(found).collect();
        let programs = programs.filter(|_| found("sbatch").is_some()).ok_or(INSTALL)?;
        let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
        let mut cluster = Self { folder, daemons: Vec::new() };
        cluster.configure().map_err(|e| format!("Slurm cannot be configured: {e}"))?;
        let at = |name: &str| cluster.at(name).to_string_lossy().into_owned();
        let munge = ["--foreground", "--force", "--num-threads=2"].map(str::to_owned).into_iter().chain(
            [("socket", "munge/socket"), ("key-file", "munge/key"), ("log-file", "munge/log")]
                .into_iter()
                .chain([("pid-file", "munge/pid"), ("seed-file", "munge/seed")])
                .map(|(option, name)| format!("--{option}={}", at(name))),
        );
        let munge: Vec<String> = munge.collect();
        let conf = at("slurm.conf");
        let words = |list: &[&str]| list.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
        cluster.spawn(&programs[0], &munge)?;
        cluster.until("munged makes its socket", |c| c.at("munge/socket").exists())?;
        cluster.spawn(&programs[1], &words(&["-D", "-i", "-c", "-f", &conf]))?;
        cluster.spawn(&programs[2], &words(&["-D", "-c", "-N", "node", "-f", &conf]))?;
        cluster.until("the node is idle", |c| {
            c.says(&["sinfo", "-h", "-o", "%T"]).is_ok_and(|s| s.trim() == "idle")
        })?;
        Ok(cluster)
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn configure(&self) -> std::io::Result<()> {
        let user = Command::new("id").arg("-un").output()?;
        let user = String::from_utf8_lossy(&user.stdout).trim().to_owned();
        for name in ["munge", "state", "spool"] {
            fs::create_dir(self.at(name))?;
        }
        for name in ["", "munge"] {
            fs::set_permissions(self.at(name), fs::Permissions::from_mode(0o755))?;
        }
        fs::write(self.at("munge/key"), (0..1024u32).map(|i| (i * i % 251) as u8).collect::<Vec<u8>>())?;
        fs::set_permissions(self.at("munge/key"), fs::Permissions::from_mode(0o400))?;
        let problem = |e: String| std::io::Error::other(e);
        let ports = [free_port().map_err(problem)?, free_port().map_err(problem)?];
        let folder = self.folder.path().display();
        // No control groups, which containers seldom have; requeued jobs wait for as long as credentials live.
        let text = format!(
            "ClusterName=test\nSlurmctldHost=localhost\nSlurmUser={user}\nSlurmdUser={user}\n\
             AuthType=auth/munge\nCredType=cred/munge\nAuthInfo=socket={folder}/munge/socket,cred_expire=8\n\
             SlurmctldPort={}\nSlurmdPort={}\nStateSaveLocation={folder}/state\nSlurmdSpoolDir={folder}/spool\n\
             SlurmctldPidFile={folder}/slurmctld.pid\nSlurmdPidFile={folder}/slurmd.pid\n\
             SlurmctldLogFile={folder}/slurmctld.log\nSlurmdLogFile={folder}/slurmd.log\n\
             ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSwitchType=switch/none\nMpiDefault=none\n\
             JobAcctGatherType=jobacct_gather/none\nSelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n\
             SchedulerType=sched/backfill\n\
             SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0,sched_min_interval=0\n\
             ReturnToService=2\nKillWait=5\nSlurmdParameters=config_overrides\n\
             NodeName=node NodeHostname=localhost NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN\n\
             PartitionName=main Nodes=node Default=YES MaxTime=INFINITE State=UP\n",
            ports[0], ports[1]
        );
        fs::write(self.at("slurm.conf"), text)
    }

    fn spawn(&mut self, program: &Path, arguments: &[String]) -> Result<(), String> {
        let mut command = Command::new(program);
        self.environment(command.args(arguments)).stdin(Stdio::null());
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn();
        self.daemons.push(child.map_err(|e| format!("cannot start {}: {e}", program.display()))?);
        Ok(())
    }

    /// For commands that speak to this Slurm.
    pub fn environment<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command.env("SLURM_CONF", self.at("slurm.conf"))
    }

    fn until(&mut self, what: &str, done: impl Fn(&Self) -> bool) -> Result<(), String> {
        let begun = Instant::now();
        while !done(self) {
            let ended = self.daemons.iter_mut().any(|daemon| daemon.try_wait().is_ok_and(|s| s.is_some()));
            if ended || begun.elapsed() > PATIENCE {
                let why = if ended { "a daemon ended" } else { "it took too long" };
                return Err(format!("Slurm does not start here: {why} before {what}: {}", self.last_words()));
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        Ok(())
    }

    /// The last lines of the logs, of which the errors tell why something does not work.
    pub fn last_words(&self) -> String {
        let logs = ["munge/log", "slurmctld.log", "slurmd.log"].map(|name| {
            let text = fs::read_to_string(self.at(name)).unwrap_or_default();
            let lines: Vec<&str> = text.lines().collect();
            let last = lines[lines.len().saturating_sub(6)..].join("\n  ");
            format!("{name}:\n  {last}")
        });
        logs.join("\n")
    }

    /// What a command prints.
    pub fn says(&self, command: &[&str]) -> Result<String, String> {
        let mut program = Command::new(command[0]);
        let output = self.environment(program.args(&command[1..])).output();
        let output = output.map_err(|e| format!("{}: {e}", command[0]))?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let error = String::from_utf8_lossy(&output.stderr);
        if output.status.success() { Ok(text) } else { Err(format!("{}: {error}", command.join(" "))) }
    }

    /// Jobs that are not done.
    pub fn jobs(&self) -> Result<Vec<Job>, String> {
        let text = self.says(&["squeue", "-h", "-r", "-o", "%A %K %T"])?;
        let job = |line: &str| {
            let mut words = line.split_whitespace();
            let (number, task, state) = (words.next()?, words.next()?, words.next()?);
            Some(Job { number: number.to_owned(), task: task.parse().ok(), state: state.to_owned() })
        };
        Ok(text.lines().filter_map(job).collect())
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        let _jobs = self.says(&["scancel", "--signal=KILL", "--full", "--state=RUNNING"]);
        let _rest = self.says(&["scancel", "--state=PENDING"]);
        let begun = Instant::now();
        while self.jobs().is_ok_and(|jobs| !jobs.is_empty()) && begun.elapsed() < Duration::from_secs(10) {
            std::thread::sleep(Duration::from_millis(100));
        }
        for daemon in self.daemons.iter_mut().rev() {
            let _term = Command::new("kill").arg(daemon.id().to_string()).status();
            let begun = Instant::now();
            while daemon.try_wait().is_ok_and(|s| s.is_none()) && begun.elapsed() < Duration::from_secs(5) {
                std::thread::sleep(Duration::from_millis(20));
            }
            let _kill = daemon.kill();
            let _gone = daemon.wait();
        }
    }
}
