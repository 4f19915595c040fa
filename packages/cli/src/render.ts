import { type Camera, printable, type Vec3, WebSplatterError } from '@websplatter/core';
import { cameraLine, prepareCamera } from './choose-camera.ts';
import type { Console } from './console.ts';
import { detailText } from './detail.ts';
import { encodeJpeg } from './jpeg.ts';
import { readModelFile } from './model-file.ts';
import { AUTO } from './options.ts';
import {
  checkOutputs,
  noteLeftOutputs,
  type Output,
  type OutputFile,
  reportBeside,
  writeFiles,
} from './output-files.ts';
import { encodePng, encodeRaw } from './png.ts';
import { posterJsx } from './poster.ts';
import { renderOnGpu } from './render-gpu.ts';
import { parseRenderArguments, type RenderOptions } from './render-options.ts';
import { renderOnReference } from './render-reference.ts';
import type { Rendered } from './rendered.ts';
import { findScene } from './scene-source.ts';
import { timingsReport } from './timings-report.ts';

/** `websplatter render SCENE … [--camera CAM.json] [--size WIDTHxHEIGHT] --out image.png`. */
export async function render(args: readonly string[], console: Console): Promise<void> {
  const options = parseRenderArguments(args);
  const { widthPx, heightPx, poster, background } = options;
  const aspect = widthPx / heightPx;
  const outputs = outputsOf(options);
  const paths = outputs.map(({ path }) => path);
  const scenes = await Promise.all(options.scenes.map((scene) => findScene(scene, options.format)));
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
