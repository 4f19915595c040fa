import { InvalidArgumentError } from '../../../data/errors.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { shown } from '../../../data/printable.ts';
import { type Records, recordWords } from './brick-records.ts';
import { BOUNDS_WORDS, type BrickResult, type BrickTask } from './brick-tasks.ts';

/** The class of a value, the members of an object, or the shape of every item of a list. */
type Shape = string | { readonly [name: string]: Shape } | readonly [Shape];

const LOSS = { count: 'Number', excess: 'Number', worst: 'Number', sum: 'Number' };
const MADE = {
  sizes: 'Uint32Array',
  bytes: 'Uint8Array',
  bounds: 'Float32Array',
  largestScales: 'Float32Array',
  errors: 'Uint16Array',
  roots: { geometry: 'Uint32Array', harmonics: 'Uint32Array' },
};
const SHAPES: Readonly<Record<BrickTask['kind'], Shape>> = {
  records: {
    run: {
      count: 'Number',
      words: 'Number',
      origin: 'Array',
      harmonics: { degree: 'Number', precision: 'String', wordsPerSplat: 'Number' },
    },
    words: 'Uint32Array',
    bounds: { min: 'Array', max: 'Array' },
  },
  count: 'Uint32Array',
  divide: { words: 'Uint32Array', counts: 'Uint32Array' },
  splats: {
    ...MADE,
    first: 'Number',
    fragments: [{ first: 'Number', words: 'Uint32Array' }],
    samples: 'Float32Array',
    rounding: {
      splats: 'Number',
      positions: LOSS,
      float32Positions: LOSS,
      scales: LOSS,
      colors: LOSS,
      harmonics: { values: 'Number', changes: 'Number', count: 'Number' },
    },
  },
  blobs: MADE,
};

/**
 * Returns the result of a writer's `run` if it fits the task.
 *
 * @throws InvalidArgumentError 'run'
 */
export function checkedResult<Task extends BrickTask>(task: Task, value: unknown): BrickResult<Task> {
  const found = misfit(value, SHAPES[task.kind], 'a result') ?? misfitOfSize(task, value as BrickResult);
  if (found === null) return value as BrickResult<Task>;
  const message = `run resolved with ${found} for a task of kind ${task.kind}. It must resolve with the result that runBrickTask has for that task.`;
  throw new InvalidArgumentError('run', message);
}

/** Describes where a value differs from a shape; null if it fits. */
function misfit(value: unknown, shape: Shape, name: string): string | null {
  const isList = Array.isArray(shape);
  const expected = typeof shape === 'string' ? shape : isList ? 'Array' : 'Object';
  // Classes of other frames fail `instanceof`; their tags are equal.
  const tag = Object.prototype.toString.call(value).slice('[object '.length, -1);
  if (tag !== expected) return `${name} that is ${shown(value)}`;
  if (typeof shape === 'string') return null;
  const members = value as Record<string, unknown>;
  for (const member of Object.keys(isList ? members : shape)) {
    const own: Shape = isList ? shape[0] : (shape as Record<string, Shape>)[member];
    const found = misfit(members[member], own, `a member ${member}`);
    if (found) return found;
  }
  return null;
}

/**
 * Describes where the lengths of a result differ from the task's; null if they fit. It detects
 * results of other tasks of the same kind.
 */
function misfitOfSize(task: BrickTask, result: BrickResult): string | null {
  const [found, expected, what] = sizesOf(task, result);
  return found === expected ? null : `${found} ${what}, where there are ${expected},`;
}

function sizesOf(task: BrickTask, result: BrickResult): [found: number, expected: number, what: string] {
  switch (task.kind) {
    case 'records': {
      const { run, words } = result as BrickResult<typeof task>;
      return [words.length / run.words, task.set.count, 'splats'];
    }
    case 'count':
      return [sumOf(result as BrickResult<typeof task>), countOf(task.parts), 'splats'];
    case 'divide': {
      const { words } = result as BrickResult<typeof task>;
      return [words.length / recordWords(task.facts.degree), countOf(task.parts), 'splats'];
    }
    case 'splats': {
      const { fragments, errors } = result as BrickResult<typeof task>;
      const words = sumOf(fragments.map((fragment) => fragment.words.length));
      const inCells = countOf(task.parts) - words / recordWords(task.facts.degree);
      return [errors.length, Math.ceil(inCells / CHUNK_SPLATS), 'cells'];
    }
    case 'blobs': {
      const { errors } = result as BrickResult<typeof task>;
      return [errors.length, task.bounds.length / BOUNDS_WORDS, 'cells'];
    }
  }
}

function countOf(parts: readonly Records[]): number {
  return sumOf(parts.map(({ run }) => run.count));
}

function sumOf(values: Uint32Array | readonly number[]): number {
  let sum = 0;
  for (const value of values) sum += value;
  return sum;
}
