import { SPLAT_FORMATS } from '../formats/formats.ts';

/** A worker for each format but PLY, which `load-splats.ts` starts by itself. In one piece each, the form that bundlers recognise. */
const WORKERS: Readonly<Record<string, () => Worker>> = {
  sog: () => new Worker(new URL('../formats/sog/sog-worker.ts', import.meta.url), { type: 'module' }),
  zip: () => new Worker(new URL('../formats/zip/zip-worker.ts', import.meta.url), { type: 'module' }),
};

/** Name of the format that files with this name are most likely of; null if it may be any. */
export function formatByName(fileName: string): string | null {
  const lower = fileName.toLowerCase();
  const format = SPLAT_FORMATS.find(({ extensions }) => extensions.some((end) => lower.endsWith(end)));
  return format?.name ?? null;
}

/** The worker that reads a format other than PLY. */
export function newFormatWorker(format: string): Worker {
  return WORKERS[format]();
}
