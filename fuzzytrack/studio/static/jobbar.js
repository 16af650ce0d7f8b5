/* Progress of the jobs of a pane: how far one is, what is left, how it ended, and its cancel. */

import { inFields } from "./columns.js";
import { html } from "./elements.js";

/** Take in what is told of a job: `job` is the one that was heard of last, `jobs` has the last of each kind. */
export function takeJob(store, job) {
  store.set({ job, jobs: { ...store.now.jobs, [job.kind]: job } });
}

/**
 * Bar and words for jobs of a kind, and the button that cancels one, which is there in place of
 * `start` while one runs.
 */
export function jobBar({ store, socket, say }, kind, label, start) {
  const cancel = html("button", { type: "button", onclick: stop }, "Cancel");
  const bar = html("progress", { max: 1, "aria-label": label });
  const words = html("p", { class: "muted", role: "status" });

  async function stop() {
    try {
      const { job } = await socket.send("cancel", { job: store.now.jobs[kind].id });
      takeJob(store, job);
    } catch (error) {
      say(error.message, "error");
    }
  }

  cancel.hidden = bar.hidden = true;
  store.follow(["job"], ({ job }) => {
    // What became of the last one stays, whatever other jobs there are.
    if (job?.kind !== kind) return;
    const busy = isBusy(job);
    start.hidden = busy;
    cancel.hidden = !busy;
    bar.hidden = !busy;
    if (busy && job.done) bar.value = job.done / job.of;
    else bar.removeAttribute("value");
    words.textContent = told(job);
    words.classList.toggle("failed", job.state === "failed");
  });
  return { element: html("div", { class: "progress" }, bar, words), cancel, words };
}

// Until there is progress.
const STARTING = {
  run: "Starting…",
  track: "Starting: the plots and the trackers are read…",
  tune: "Starting: the data are read, or simulated…",
};

/** End jobs that the server does not know, since it was started again meanwhile; it knows `jobs`. */
export function endLost(store, jobs) {
  for (const job of Object.values(store.now.jobs)) {
    if (isBusy(job) && !jobs.some(({ id, kind }) => id === job.id && kind === job.kind))
      takeJob(store, { ...job, state: "failed", error: "the server was started again; start this again as well" });
  }
}

/** Whether a job has not ended. */
export function isBusy(job) {
  return job?.state === "running" || job?.state === "waiting";
}

/** A job in words. */
function told({ kind, done, of, seconds, seconds_left: left, state, error }) {
  const count = kind === "run" ? `${done} of ${of} runs` : `${Math.round((100 * done) / of)} %`;
  if (state === "waiting") return "Waiting: another job runs, of this page or another one…";
  if (state === "running" && !done) return STARTING[kind];
  if (state === "running") return `${count}${left === null ? "" : `, ${duration(left)} left`}`;
  if (state === "replaced") return "";
  if (state === "cancelled") return `Canceled after ${count}.`;
  if (state === "failed") return `Failed: ${inFields(error)}`;
  return `${kind === "run" ? `${of} runs` : "Done"} in ${duration(seconds)}.`;
}

function duration(seconds) {
  if (seconds < 9.95) return `${seconds.toFixed(1)} s`;
  if (seconds < 90) return `${Math.round(seconds)} s`;
  return `${Math.round(seconds / 60)} min`;
}
