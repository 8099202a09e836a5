# shellcheck shell=bash disable=SC2034 # what is set here is used by the scripts that source this file
# What the batch scripts share; sourced by run.slurm, run.pbs, run.lsf and sweep.*. Bash.
#
#   find_equimap               sets `equimap`: $EQUIMAP, else build/equimap of this tree, else the installed one
#   find_launcher              sets `launcher`: $EQUIMAP_MPIRUN, else mpirun on $ranks ranks; deaf to TERM
#   with_checkpoint ARGS...    sets `arguments`: ARGS with a checkpoint beside the output, and -restart where one lies there
#   watch_the_clock SECONDS    adds -wall_time to them, for a job that has so long and is not warned before its end
#   run_and_forward COMMAND... runs it, hands USR1 and TERM on as USR1; sets `told` to the last of them, `code` to its exit code,
#                              75 also where one of them or a preemption, which `preempted` knows of, has ended the launcher
#   finish                     ends the script with `code`; after 75, puts the job back into the queue with `requeue`, at most
#                              $EQUIMAP_REQUEUES times (20), `attempt` being how often that has happened already, and not if
#                              `withheld` says why not
#   sweep_row ROW TABLE ...    one row of a sweep, or the whole sweep if ROW is empty, to the end of the script
jobs_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
stopped=75 # equimap's exit code for "stopped on request with a checkpoint"

say() { echo "$(date '+%F %T') $*"; }

# A request to stop is taken from the first moment on, also when nothing has been started yet.
told='' child='' woken=no
take() {
  told=$1 woken=yes
  say "told to stop ($1)"
  [ -z "$child" ] || kill -USR1 "$child" 2>/dev/null
}
trap 'take USR1' USR1
trap 'take TERM' TERM

find_equimap() {
  equimap=${EQUIMAP:-$jobs_dir/../build/equimap}
  [ -n "${EQUIMAP:-}" ] || [ -x "$equimap" ] || equimap=$(command -v equimap || true)
  if [ -z "$equimap" ] || [ ! -x "$equimap" ]; then
    say "there is no program '${equimap:-equimap}'; build it, or set EQUIMAP to where it is" >&2
    exit 2
  fi
}

# Open MPI ties a rank to one core unless told otherwise, and refuses root unless told twice.
find_launcher() {
  if [ "$(id -u)" -eq 0 ]; then
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  fi
  launcher=(mpirun -n "$ranks" --bind-to none)
  [ -z "${EQUIMAP_MPIRUN:-}" ] || read -ra launcher <<<"${EQUIMAP_MPIRUN//%n/$ranks}"
  # TERM goes to every process of a job. Of it mpirun ends the ranks, and itself, at once; deaf, it waits for their checkpoint.
  ! env --block-signal=TERM true 2>/dev/null || launcher=(env --block-signal=TERM "${launcher[@]}")
}

# The value of an option in ARGS, or nothing.
option_value() {
  local name=$1
  shift
  while [ $# -gt 1 ]; do
    [ "$1" != "$name" ] || { echo "$2"; return; }
    shift
  done
}

# register has several, called CHECKPOINT.1 and so on; the first is always there.
has_checkpoint() {
  local name
  for name in "$checkpoint" "$checkpoint.previous" "$checkpoint.1" "$checkpoint.1.previous"; do
    [ ! -e "$name" ] || return 0
  done
  return 1
}

with_checkpoint() {
  local output
  arguments=("$@")
  output=$(option_value -o "$@")
  checkpoint=$(option_value -checkpoint "$@")
  if [ -z "$checkpoint" ]; then
    checkpoint=${output%%,*}
    checkpoint=${checkpoint%.*}.checkpoint.h5
    arguments+=(-checkpoint "$checkpoint")
  fi
  if [ -z "$(option_value -restart "$@")" ] && has_checkpoint; then
    say "going on from $checkpoint"
    arguments+=(-restart "$checkpoint")
  fi
}

run_and_forward() {
  "$@" &
  child=$!
  [ -z "$told" ] || kill -USR1 $child
  woken=yes
  while [ $woken = yes ]; do # a signal ends the waiting, not the program
    woken=no
    code=0
    wait $child || code=$?
  done
  child=''
  # A launcher that a signal has ended returns no code of equimap's (-1, if bash has lost it to a signal in the same instant),
  # and may end before the signal gets here: the run has been stopped all the same.
  case $code in
    0 | [2-7] | "$stopped") ;;
    *)
      sleep 1
      if [ -n "$told" ] || preempted; then
        say "the launcher ended with code $code"
        code=$stopped
      fi
      ;;
  esac
  trap '' USR1 TERM # what is left is short, and must not be cut short
}

# A run that has come to its end needs no checkpoint; one that has only come to -max_it (4) may be given more.
forget_checkpoint() {
  if [ "$code" -eq 0 ] && [ -n "${checkpoint:-}" ]; then
    rm -f "$checkpoint" "$checkpoint.previous" "$checkpoint".[0-9]* "${checkpoint%.h5}"{,.a,.b}.mesh.h5
  fi
}

# What a batch system that can tell overrides.
preempted() { return 1; }
withheld() { return 1; }

finish() {
  local most=${EQUIMAP_REQUEUES:-20} reason
  if [ "$code" -ne $stopped ]; then
    forget_checkpoint
    say "ended with exit code $code"
  elif reason=$(withheld); then
    say "stopped; $reason"
  elif [ "$attempt" -ge "$most" ]; then
    say "stopped, and back in the queue $attempt times already: enough (EQUIMAP_REQUEUES=$most);" \
      "submit it by hand to go on" >&2
  else
    # Said before it is done: Slurm may end this script before requeue returns.
    say "stopped; back into the queue ($((attempt + 1)) of at most $most)"
    requeue || say "could not be put back into the queue; submit it by hand to go on" >&2
  fi
  exit "$code"
}

sweep_row() {
  local row=$1
  shift
  say "sweep ${row:+row $row }$*, attempt $((attempt + 1))"
  # What ended an earlier attempt at a row was no failure of its own.
  [ -z "$row" ] || set -- "$@" --rows "$row" --no-collect
  [ -z "$row" ] || [ "$attempt" -eq 0 ] || set -- "$@" --retry
  run_and_forward "$jobs_dir/sweep.py" "$@"
  finish
}

# ---- a clock to watch: three minutes, or a tenth of a short time, are kept for the checkpoint and the end
wall_time() {
  local seconds=$1 kept
  kept=$((seconds / 10 < 180 ? seconds / 10 : 180))
  [ "$seconds" -eq 0 ] || echo $((seconds - kept))
}
watch_the_clock() {
  local limit
  limit=$(wall_time "$1")
  [ -z "$limit" ] || [ -n "$(option_value -wall_time "${arguments[@]}")" ] || arguments+=(-wall_time "$limit")
}

# ---- Slurm
# The job's name for scontrol. Of the last task of an array the plain number would mean the whole array.
slurm_job() { echo "${SLURM_ARRAY_JOB_ID:+${SLURM_ARRAY_JOB_ID}_}${SLURM_ARRAY_TASK_ID:-$SLURM_JOB_ID}"; }
slurm_shown() { scontrol --oneliner show job "$(slurm_job)"; }
slurm_requeue() { scontrol requeue "$(slurm_job)"; }
# On several nodes the signal at the beginning of the grace time ends mpirun's daemons, and does not get to the batch script.
slurm_preempted() { [[ $(slurm_shown) =~ " PreemptTime="[0-9] ]]; }
# A job that is COMPLETING while its script still runs has been ended by Slurm: its time is up, somebody has put it back into
# the queue (which Restarts counts at once), or it is cancelled. Slurm would requeue that, too.
slurm_withheld() {
  local job
  job=$(slurm_shown)
  [[ $job =~ " JobState="(COMPLETING|CANCELLED|PREEMPTED|REQUEUED|PENDING)" " && $job != *" Reason=TimeLimit "* ]] || return 1
  if [[ $job =~ " Restarts="([0-9]+) && ${BASH_REMATCH[1]} -gt $attempt ]]; then
    echo "Slurm has put it back into the queue"
  else
    echo "cancelled; submit it by hand to go on"
  fi
}

# ---- PBS
# The job's walltime in seconds; 0 if it cannot be told.
pbs_seconds() {
  local text hours minutes seconds
  text=${EQUIMAP_WALLTIME:-$(qstat -f "${PBS_JOBID:-}" 2>/dev/null | sed -n 's/.*Resource_List.walltime = //p')}
  [[ $text =~ ^([0-9]+):([0-9]+):([0-9]+)$ ]] || { echo 0; return; }
  hours=${BASH_REMATCH[1]} minutes=${BASH_REMATCH[2]} seconds=${BASH_REMATCH[3]}
  echo $((10#$hours * 3600 + 10#$minutes * 60 + 10#$seconds))
}
# TERM comes of qdel, of a preemption, after which PBS runs the job again by itself (-r y), and when the time is up.
pbs_withheld() {
  local limit
  [ "$told" = TERM ] || return 1
  limit=$(pbs_seconds)
  [ "$limit" -eq 0 ] || [ $((SECONDS + 60)) -lt "$limit" ] || return 1
  echo "ended by PBS; if it was deleted, submit it by hand to go on"
}
# Submit SCRIPT with this job's environment and resources, which submit.py leaves in EQUIMAP_QSUB.
pbs_submit_again() {
  local resources
  eval "resources=(${EQUIMAP_QSUB:-})"
  export EQUIMAP_ATTEMPT=$((attempt + 1)) EQUIMAP_JOBS=$jobs_dir
  qsub -V "${resources[@]}" "$1"
}

# ---- LSF: a requeued job keeps its number, and nobody counts but we
lsf_attempt() {
  counter=$1.requeues-${LSB_JOBID:-0}
  attempt=$(cat "$counter" 2>/dev/null || echo 0)
}
# Code 75 makes LSF requeue the job (-Q 75): that is given only while there is a turn left.
lsf_finish() {
  local most=${EQUIMAP_REQUEUES:-20}
  if [ "$code" -eq $stopped ] && [ "$attempt" -lt "$most" ]; then
    echo $((attempt + 1)) >"$counter"
    say "stopped with a checkpoint; back into the queue ($((attempt + 1)) of at most $most)"
    exit $stopped
  fi
  rm -f "$counter"
  forget_checkpoint
  if [ "$code" -eq $stopped ]; then
    code=1
    say "stopped with a checkpoint, and requeued $attempt times already: enough (EQUIMAP_REQUEUES=$most);" \
      "submit it by hand to go on" >&2
  fi
  say "ended with exit code $code"
  exit "$code"
}
