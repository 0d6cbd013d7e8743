// The judge in a worker of its own, so that the page stays awake: a program for WASI that gets a request on its standard input
// and answers on its standard output. Of WASI it has what that takes; there are no files, no sockets and no threads.

'use strict';

/** What WASI returns for what is not there. */
const NOT_SUPPORTED = 58;
const BAD_DESCRIPTOR = 8;

/** The program ends. */
class Exit extends Error {
  constructor(code) {
    super(`the judge ended with ${code}`);
    this.code = code;
  }
}

/** Runs a program once; what it writes to its standard output. */
function run(module, input) {
  const written = [[], []];
  let memory;
  let taken = 0;
  const view = () => new DataView(memory.buffer);
  const put = (at, value) => view().setUint32(at, value, true);
  const buffers = (list, count) => Array.from({ length: count }, (_, k) => {
    const all = view();
    return new Uint8Array(memory.buffer, all.getUint32(list + 8 * k, true), all.getUint32(list + 8 * k + 4, true));
  });
  const none = (count, size) => {
    put(count, 0);
    put(size, 0);
    return 0;
  };
  const system = {
    args_sizes_get: none,
    environ_sizes_get: none,
    args_get: () => 0,
    environ_get: () => 0,
    sched_yield: () => 0,
    fd_prestat_get: () => BAD_DESCRIPTOR,
    fd_read(descriptor, list, count, read) {
      if (descriptor !== 0) return BAD_DESCRIPTOR;
      const before = taken;
      for (const buffer of buffers(list, count)) {
        const part = input.subarray(taken, taken + buffer.length);
        buffer.set(part);
        taken += part.length;
      }
      put(read, taken - before);
      return 0;
    },
    fd_write(descriptor, list, count, length) {
      if (descriptor !== 1 && descriptor !== 2) return BAD_DESCRIPTOR;
      const parts = buffers(list, count).map((buffer) => buffer.slice());
      written[descriptor - 1].push(...parts);
      put(length, parts.reduce((sum, part) => sum + part.length, 0));
      return 0;
    },
    clock_time_get(clock, _precision, time) {
      const ms = clock === 0 ? Date.now() : performance.now();
      view().setBigUint64(time, BigInt(Math.round(ms * 1e6)), true);
      return 0;
    },
    random_get(at, length) {
      crypto.getRandomValues(new Uint8Array(memory.buffer, at, length));
      return 0;
    },
    proc_exit(code) {
      throw new Exit(code);
    },
  };
  const wasi = new Proxy(system, { get: (all, name) => all[name] ?? (() => NOT_SUPPORTED) });
  const instance = new WebAssembly.Instance(module, { wasi_snapshot_preview1: wasi });
  memory = instance.exports.memory;
  const text = (parts) => new Blob(parts).text();
  try {
    instance.exports._start();
  } catch (error) {
    if (!(error instanceof Exit)) throw error;
    if (error.code !== 0) return text(written[1]).then((said) => Promise.reject(new Error(said.trim() || error.message)));
  }
  return text(written[0]);
}

let judge;
self.onmessage = async ({ data }) => {
  try {
    if (data.program) {
      judge = WebAssembly.compile(data.program);
    } else {
      self.postMessage({ verdict: JSON.parse(await run(await judge, data.request)) });
    }
  } catch (error) {
    self.postMessage({ error: error.message });
  }
};
