// Set up for each file of tests: under `--cost`, writes the CPU time of each test as a line of JSON, which
// cost-table.mjs sums up. One worker runs one test after another, so that all that the processes of the run
// spend is the running test's.
import { appendFileSync, readdirSync, readFileSync } from 'node:fs';
import { relative } from 'node:path';
import { afterEach, beforeAll, beforeEach } from 'vitest';

/** Clock ticks per second of /proc/PID/stat. */
const TICKS_PER_S = 100;

/** CPU time that a tree of processes has taken so far, ms. */
interface TreeCpu {
  /** User and system time of all processes, also of those that ended and were waited for. */
  readonly totalMs: number;
  /** The part of browsers' GPU processes that are alive. */
  readonly browserGpuMs: number;
}

/** Whether each process is a browser's GPU process, by its id. */
const isGpuProcess = new Map<number, boolean>();

/** Reads the CPU time of process `root` and all of its descendants, on Linux, to 10 ms per process. */
function treeCpu(root: number): TreeCpu {
  const parents = new Map<number, number>();
  const elapsedMs = new Map<number, number>();
  for (const name of readdirSync('/proc')) {
    const pid = Number(name);
    if (!(pid > 0)) continue;
    const stat = readOrNull(`/proc/${pid}/stat`);
    if (!stat) continue;
    // The second field, a name in parentheses, may contain spaces and parentheses.
    const fields = stat.slice(stat.lastIndexOf(')') + 2).split(' ');
    const ticks = fields.slice(11, 15).reduce((sum, field) => sum + Number(field), 0);
    parents.set(pid, Number(fields[1]));
    elapsedMs.set(pid, (ticks * 1000) / TICKS_PER_S);
  }
  let totalMs = 0;
  let browserGpuMs = 0;
  for (const [pid, ms] of elapsedMs) {
    let ancestor: number | undefined = pid;
    while (ancestor && ancestor !== root) ancestor = parents.get(ancestor);
    if (ancestor !== root) continue;
    totalMs += ms;
    if (isBrowserGpu(pid)) browserGpuMs += ms;
  }
  return { totalMs, browserGpuMs };
}

function isBrowserGpu(pid: number): boolean {
  const known = isGpuProcess.get(pid);
  if (known !== undefined) return known;
  const found = readOrNull(`/proc/${pid}/cmdline`)?.includes('--type=gpu-process') ?? false;
  isGpuProcess.set(pid, found);
  return found;
}

/** Returns the text of a file of /proc; null if the process has ended. */
function readOrNull(path: string): string | null {
  try {
    return readFileSync(path, 'utf8');
  } catch {
    return null; // It has ended since its folder was listed, and its time went to its parent.
  }
}

/** CPU time of this process while something of a kind is under way. */
class Span {
  spentMs = 0;
  #pending = 0;
  #since = 0;

  async during<Result>(work: Promise<Result>): Promise<Result> {
    if (this.#pending++ === 0) this.#since = ownCpuMs();
    try {
      return await work;
    } finally {
      if (--this.#pending === 0) this.spentMs += ownCpuMs() - this.#since;
    }
  }
}

function ownCpuMs(): number {
  const { user, system } = process.cpuUsage();
  return (user + system) / 1000;
}

interface Spans {
  readonly compile: Span;
  readonly draw: Span;
}

/** Files of a shared process are set up one after another: the process's spans outlive their modules. */
const shared = globalThis as { costSpans?: Spans };

/** Measures what Dawn compiles and draws in this process. */
function watchGpu(): Spans | null {
  if (shared.costSpans || typeof GPUDevice === 'undefined') return shared.costSpans ?? null;
  const [compile, draw] = [new Span(), new Span()];
  shared.costSpans = { compile, draw };
  for (const name of ['createComputePipelineAsync', 'createRenderPipelineAsync'] as const) {
    const create = GPUDevice.prototype[name] as (descriptor: never) => Promise<GPUObjectBase>;
    GPUDevice.prototype[name] = function (this: GPUDevice, descriptor: never) {
      return compile.during(create.call(this, descriptor));
    } as never;
  }
  const { submit } = GPUQueue.prototype;
  GPUQueue.prototype.submit = function (this: GPUQueue, commands) {
    const result = submit.call(this, commands);
    // A lost device ends no work.
    draw.during(this.onSubmittedWorkDone()).catch(() => {});
    return result;
  };
  return shared.costSpans;
}

function measureInto(path: string, root: number): void {
  let begun = { ...treeCpu(root), compileMs: 0, drawMs: 0 };
  const now = () => {
    const spans = watchGpu();
    const compileMs = spans?.compile.spentMs ?? 0;
    return { ...treeCpu(root), compileMs, drawMs: spans?.draw.spentMs ?? 0 };
  };
  beforeAll(() => {
    watchGpu();
  });
  beforeEach(() => {
    begun = now();
  });
  afterEach(({ task }) => {
    const file = relative(process.cwd(), task.file.filepath);
    const line = {
      project: task.file.projectName,
      file,
      test: task.fullTestName ?? task.name,
      begun,
      ended: now(),
    };
    appendFileSync(path, `${JSON.stringify(line)}\n`);
  });
}

const { WEBSPLATTER_COSTS, WEBSPLATTER_COSTS_ROOT } = process.env;
if (WEBSPLATTER_COSTS) measureInto(WEBSPLATTER_COSTS, Number(WEBSPLATTER_COSTS_ROOT));
