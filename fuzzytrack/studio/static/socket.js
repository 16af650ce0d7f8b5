/* The connection to the server: commands with a sequence number, and their answers. */

const HEADER_BYTES = 24;
const LONGEST_PAUSE = 5000;
const MOVED = 4001;

/** What the server says when it does not do a command. */
class Refusal extends Error {}

/** Open the connection and keep it open; `heard(event, message)` gets "open", "close" and pushes. */
export function connect(token, heard) {
  const pending = new Map();
  const channels = new Map();
  let seq = 0;
  let pause = 250;
  let wire = null;

  function open() {
    wire = new WebSocket(`ws://${location.host}/socket`, ["fuzzytrack", `token.${token}`]);
    wire.binaryType = "arraybuffer";
    wire.onopen = () => {
      pause = 250;
      heard("open");
    };
    wire.onmessage = ({ data }) => (typeof data === "string" ? hear(JSON.parse(data)) : draw(data));
    wire.onclose = ({ code }) => {
      for (const { reject } of pending.values()) {
        reject(new Refusal("The connection to the server was lost; the last change may be missing."));
      }
      pending.clear();
      heard("close");
      // Another tab has this session now, and would take it back in turn.
      if (code === MOVED) return;
      setTimeout(open, pause);
      pause = Math.min(2 * pause, LONGEST_PAUSE);
    };
  }

  function hear(message) {
    if (message.event) {
      heard(message.event, message);
      return;
    }
    const asked = pending.get(message.seq);
    pending.delete(message.seq);
    if (!asked) return;
    if (message.error === undefined) asked.resolve(message.result);
    else asked.reject(new Refusal(message.error));
  }

  function draw(buffer) {
    const [number, rows, columns, layers] = new Uint32Array(buffer, 0, 4);
    const values = new Float32Array(buffer, HEADER_BYTES);
    const size = rows * columns;
    const asked = pending.get(number);
    pending.delete(number);
    asked?.resolve({
      rows,
      columns,
      layers: Array.from({ length: layers }, (_, k) => values.subarray(k * size, (k + 1) * size)),
    });
  }

  /** Send a command; the promise brings its result, or a Refusal. */
  function send(command, args = {}) {
    if (wire?.readyState !== WebSocket.OPEN) {
      return Promise.reject(
        new Refusal("There is no connection to the server; start `fuzzytrack studio` again."),
      );
    }
    seq += 1;
    const number = seq;
    return new Promise((resolve, reject) => {
      pending.set(number, { resolve, reject });
      wire.send(JSON.stringify({ seq: number, command, arguments: args }));
    });
  }

  /**
   * Send a command of which only the newest counts: one is in flight, and of those that come
   * meanwhile the newest waits. The promise of one that was replaced brings undefined.
   */
  function latest(channel, command, args) {
    return new Promise((resolve, reject) => {
      const waiting = { command, args, resolve, reject };
      const lane = channels.get(channel);
      if (!lane) {
        channels.set(channel, { next: null });
        run(channel, waiting);
      } else {
        lane.next?.resolve(undefined);
        lane.next = waiting;
      }
    });
  }

  function run(channel, { command, args, resolve, reject }) {
    send(command, args)
      .then(resolve, reject)
      .finally(() => {
        const { next } = channels.get(channel);
        if (next) {
          channels.get(channel).next = null;
          run(channel, next);
        } else channels.delete(channel);
      });
  }

  open();
  return { send, latest };
}
