import { basename } from 'node:path';
import { type Camera, cameraPosition, printable, type Vec3, WebSplatterError } from '@websplatter/core';
import { timeSpread } from '@websplatter/core/measure';
import { cameraLine, prepareCamera } from './choose-camera.ts';
import type { Console } from './console.ts';
import { detailText } from './detail.ts';
import { encodeJpeg, encodePng, encodeRaw } from './images.ts';
import { InputFileError } from './input-error.ts';
import { isNumbers, isObject, readJsonFile, shown } from './json-file.ts';
import { currentCommit, describeMachine } from './machine.ts';
import { AUTO } from './options.ts';
import {
  checkOutputs,
  noteLeftOutputs,
  type Output,
  type OutputFile,
  reportBeside,
  writeFiles,
} from './output-files.ts';
import { renderOnGpu } from './render-gpu.ts';
import { parseRenderArguments, type RenderOptions } from './render-options.ts';
import { renderOnReference } from './render-reference.ts';
import type { Rendered } from './rendered.ts';
import { findScene } from './scene-source.ts';

/** `websplatter render SCENE … [--camera CAM.json] [--size WIDTHxHEIGHT] --out image.png`. */
export async function render(args: readonly string[], console: Console): Promise<void> {
  const options = parseRenderArguments(args);
  const { widthPx, heightPx, poster, background } = options;
  const aspect = widthPx / heightPx;
  const outputs = outputsOf(options);
  const paths = outputs.map(({ path }) => path);
  const scenes = await Promise.all(
    options.scenes.map((scene) => findScene(scene, options.format, options.time)),
  );
  const cameraFiles = options.camera === AUTO ? [] : [options.camera];
  const filesRead = () => [...cameraFiles, ...options.models, ...scenes.flatMap(({ files }) => [...files])];
  await checkOutputs(outputs, filesRead());
  await noteLeftOutputs(outputs, console);
  const report = await reportBeside(paths, console);
  const choice = await prepareCamera(options, aspect);
  const jsxOf = (camera: Camera, up?: Vec3) =>
    poster === undefined
      ? ''
      : `${posterJsx(poster, camera, { cameraFile: options.camera, aspect, background, up })}\n`;
  // Cameras of which there is no JSX are refused before the work.
  if (choice.given) jsxOf(choice.given);
  const models = await Promise.all(options.models.map(readModelFile));

  const renderWith = options.renderer === 'reference' ? renderOnReference : renderOnGpu;
  const rendered = await renderWith(scenes, models, choice, options, console);
  const { camera, found, notes } = rendered.chosen;
  if (rendered.notices.length > 0) console.err(`note: ${rendered.notices.join('; ')}\n`);
  for (const note of notes) console.err(`note: ${note}\n`);

  await writeFiles(
    outputs.map((output) => ({ ...output, content: contentOf(output, rendered, options) })),
    filesRead(),
  );
  if (rendered.firstDifference) {
    const { frame, pixels } = rendered.firstDifference;
    throw new WebSplatterError(
      'frames-differ',
      `frame ${frame} of ${options.frames} differs from the first in ${pixels} of ${widthPx * heightPx} pixels; ${paths.join(', ')} hold the last`,
    );
  }
  const splats = rendered.splatsPerScene.reduce((sum, count) => sum + count, 0);
  const detail = detailText(options.detail, rendered.visibleSplats, splats, rendered.psnrDb);
  report(
    `${printable(paths.join(', '))}: ${widthPx}×${heightPx}, ${rendered.visibleSplats} of ${splats} splats, ${rendered.label}\n${detail === null ? '' : `detail: ${detail}\n`}${cameraLine(found)}${jsxOf(camera, found?.up)}`,
  );
}

function outputsOf({ out, raw, poster, timings }: RenderOptions): Output[] {
  const paths = { '--out': out, '--raw': raw, '--poster': poster, '--timings': timings };
  return Object.entries(paths).flatMap(([argument, path]) =>
    path === undefined ? [] : [{ argument, path }],
  );
}

function contentOf(
  { argument, path }: Output,
  rendered: Rendered,
  options: RenderOptions,
): OutputFile['content'] {
  if (argument === '--poster' && !/\.png$/i.test(path)) return encodeJpeg(rendered.image, options.background);
  if (argument === '--out' || argument === '--poster') return encodePng(rendered.image, options.background);
  if (argument === '--raw') return encodeRaw(rendered.image);
  return `${JSON.stringify(timingsReport(options, rendered), null, 2)}\n`;
}

/** Reads a scene's model matrix: 16 numbers, column-major, or `{ "matrix": […] }`. */
async function readModelFile(file: string): Promise<Float64Array> {
  return parseModel(await readJsonFile(file, 'model matrix'), file);
}

/** @throws InputFileError that names the file and the problem. */
export function parseModel(json: unknown, file: string): Float64Array {
  const matrix = isObject(json) ? json.matrix : json;
  const place = isObject(json) ? 'field matrix' : undefined;
  if (!isNumbers(matrix, 16)) {
    throw new InputFileError(
      file,
      `a model matrix is 16 finite numbers, column-major, found ${shown(matrix)}`,
      place,
    );
  }
  const isAffine = matrix[3] === 0 && matrix[7] === 0 && matrix[11] === 0 && matrix[15] === 1;
  if (!isAffine) {
    const lastRow = [matrix[3], matrix[7], matrix[11], matrix[15]];
    const advice = 'is the matrix row-major? It is read column-major, the translation in elements 12 to 14';
    throw new InputFileError(
      file,
      `the last row must be 0, 0, 0, 1, found ${lastRow.join(', ')}; ${advice}`,
      place,
    );
  }
  return Float64Array.from(matrix);
}

const STAGES = ['preprocessMs', 'sortMs', 'rasterizeMs', 'totalMs', 'wallClockMs'] as const;

/** Contents of the file that `--timings` writes. */
function timingsReport(options: RenderOptions, rendered: Rendered) {
  const { timings, splatsPerScene } = rendered;
  const { accuracy } = options;
  const { alphaCutoff, sortKeyBits, extent, culling, resolutionScale } = accuracy;
  return {
    source: timings[0]?.source ?? null,
    /** Milliseconds; null for a stage that was not measured by itself. */
    stages: Object.fromEntries(STAGES.map((stage) => [stage, spreadOf(timings.map((each) => each[stage]))])),
    /** Both times are medians of rasterising, or of whole frames without timestamps. */
    rasterizer: rendered.rasterizer,
    frames: options.frames,
    warmUpFrames: rendered.warmUpFrames,
    measuredFrames: timings.length,
    framesIdentical: rendered.firstDifference === null,
    scenes: options.scenes.map((name, i) => ({ name, splats: splatsPerScene[i] })),
    visibleSplats: rendered.visibleSplats,
    widthPx: options.widthPx,
    heightPx: options.heightPx,
    detail: options.detail,
    renderer: options.renderer,
    adapter: rendered.label,
    accuracy:
      options.renderer === 'reference'
        ? { alphaCutoff, sortKeyBits, extent, culling, resolutionScale }
        : { label: options.accuracyLabel, ...accuracy },
    notices: rendered.notices,
    commit: currentCommit(),
    machine: describeMachine(),
  };
}

function spreadOf(timesMs: readonly number[]) {
  const measuredMs = timesMs.filter((timeMs) => !Number.isNaN(timeMs));
  if (measuredMs.length === 0) return null;
  const { median, p99 } = timeSpread(measuredMs);
  return { median, p99 };
}

/** Part by which the sides of a pixel may differ without a visible change of the picture. */
const MAX_STRETCH = 1e-6;

/**
 * Returns the JSX of a `<SplatCanvas>` that begins with the view of a poster at `path`.
 *
 * @param cameraFile for messages.
 * @param aspect width of the poster divided by its height.
 * @param background sRGB, 0…1.
 * @param up about which controls are to turn the camera; default +y.
 * @throws InputFileError that names the camera's file if react-three-fiber has no such camera.
 */
export function posterJsx(
  path: string,
  camera: Camera,
  {
    cameraFile,
    aspect,
    background,
    up = [0, 1, 0],
  }: {
    readonly cameraFile: string;
    readonly aspect: number;
    readonly background: Vec3;
    readonly up?: Vec3;
  },
): string {
  const { viewMatrix: v, projectionMatrix: p, near, far } = camera;
  const isCentred = [1, 4, 8, 9].every((i) => p[i] === 0) && p[5] > 0;
  if (p[11] !== -1 || !isCentred || Math.abs((p[0] * aspect) / p[5] - 1) > MAX_STRETCH)
    throw new InputFileError(
      cameraFile,
      '--poster needs a camera with which a <SplatCanvas> can begin: in perspective, with the middle of its view in the middle of the image, and square pixels',
    );
  const position = cameraPosition(v).map((value) => Number(value.toPrecision(8)));
  const rotation = anglesOf(v).map((angle) => Number(angle.toFixed(6)));
  const fov = Number(((2 * Math.atan(1 / p[5]) * 180) / Math.PI).toFixed(6));
  const list = (values: readonly number[]) => `[${values.map((value) => value + 0).join(', ')}]`;
  const isUsualUp = up[0] === 0 && up[1] > 0 && up[2] === 0;
  const upProp = isUsualUp ? '' : `up: ${list(up)}, `;
  const props = `${upProp}position: ${list(position)}, rotation: ${list(rotation)}, fov: ${fov}, near: ${near}, far: ${far}`;
  const color = background.map((value) => Math.round(255 * value)).join(' ');
  return `<SplatCanvas poster="/${encodeURIComponent(basename(path))}" camera={{ ${props} }} style={{ background: 'rgb(${color})' }} flat>`;
}

/** three's Euler angles about x, y and z, in this order, of a camera with this view matrix. */
function anglesOf(v: ArrayLike<number>): [number, number, number] {
  // The rotation of the camera is the inverse of the view's: its row i is column i of that.
  const y = Math.asin(Math.min(1, Math.max(-1, v[2])));
  // Looking along x, turns about x and z are the same.
  if (Math.abs(v[2]) > 0.9999999) return [Math.atan2(v[9], v[5]), y, 0];
  return [Math.atan2(-v[6], v[10]), y, Math.atan2(-v[1], v[0])];
}
