import { printable, WebSplatterError } from '@websplatter/core';
import { readCameraFile } from './camera-file.ts';
import type { Console } from './console.ts';
import { readModelFile } from './model-file.ts';
import { checkWritable, type OutputFile, writeFiles } from './output-files.ts';
import { encodePng, encodeRaw } from './png.ts';
import { renderOnGpu } from './render-gpu.ts';
import { parseRenderArguments } from './render-options.ts';
import { renderOnReference } from './render-reference.ts';
import { findScene } from './scene-source.ts';
import { timingsReport } from './timings-report.ts';

/** `websplatter render SCENE … --camera CAM.json --size WIDTHxHEIGHT --out image.png`. */
export async function render(args: readonly string[], console: Console): Promise<void> {
  const options = parseRenderArguments(args);
  const { widthPx, heightPx, out, raw, timings } = options;
  const outputs = [out, raw, timings].filter((path) => path !== undefined);
  for (const path of outputs) await checkWritable(path);
  const camera = await readCameraFile(options.camera, widthPx / heightPx);
  const models = await Promise.all(options.models.map(readModelFile));
  const scenes = await Promise.all(options.scenes.map(findScene));

  const renderWith = options.renderer === 'reference' ? renderOnReference : renderOnGpu;
  const rendered = await renderWith(scenes, models, camera, options);
  if (rendered.notices.length > 0) console.err(`note: ${rendered.notices.join('; ')}\n`);

  const files: OutputFile[] = [];
  if (out !== undefined) files.push({ path: out, content: encodePng(rendered.image, options.background) });
  if (raw !== undefined) files.push({ path: raw, content: encodeRaw(rendered.image) });
  if (timings !== undefined) {
    files.push({ path: timings, content: `${JSON.stringify(timingsReport(options, rendered), null, 2)}\n` });
  }
  await writeFiles(files);
  if (rendered.firstDifference) {
    const { frame, pixels } = rendered.firstDifference;
    throw new WebSplatterError(
      'frames-differ',
      `frame ${frame} of ${options.frames} differs from the first in ${pixels} of ${widthPx * heightPx} pixels; ${outputs.join(', ')} hold the last`,
    );
  }
  const splats = rendered.splatsPerScene.reduce((sum, count) => sum + count, 0);
  console.out(
    `${printable(outputs.join(', '))}: ${widthPx}×${heightPx}, ${rendered.visibleSplats} of ${splats} splats, ${rendered.label}\n`,
  );
}
