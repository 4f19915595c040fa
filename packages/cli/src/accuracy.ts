import { ACCURACY_PRESETS, frameScene, printable } from '@websplatter/core';
import { type AccuracyTable, cameraAtDistance, measureAccuracy } from '@websplatter/core/measure';
import { accuracyChart } from './accuracy-chart.ts';
import { type AccuracyOptions, parseAccuracyArguments } from './accuracy-options.ts';
import { accuracyJson, accuracyText } from './accuracy-report.ts';
import { cameraLine, type FoundCamera, prepareCamera } from './choose-camera.ts';
import { type Console, tenthsOf } from './console.ts';
import { findDetail } from './detail.ts';
import { openGpuSession } from './gpu-session.ts';
import { AUTO } from './options.ts';
import { checkOutputs, noteLeftOutputs, type Output, reportBeside, writeFiles } from './output-files.ts';
import { findScene, type SceneSource } from './scene-source.ts';

/** `websplatter accuracy SCENE … [--camera CAM.json] [--size WxH] [--json] [--svg chart.svg]`. */
export async function accuracy(args: readonly string[], console: Console): Promise<void> {
  const options = parseAccuracyArguments(args);
  const outputs: Output[] = options.svg === undefined ? [] : [{ argument: '--svg', path: options.svg }];
  const scenes = await Promise.all(options.scenes.map((scene) => findScene(scene, options.format)));
  const cameraFiles = options.camera === AUTO ? [] : [options.camera];
  const filesRead = () => [...cameraFiles, ...scenes.flatMap(({ files }) => [...files])];
  await checkOutputs(outputs, filesRead());
  await noteLeftOutputs(outputs, console);
  const report = await reportBeside(
    outputs.map(({ path }) => path),
    console,
  );
  const { table, found } = await measure(options, scenes, console);
  const { scenes: names, distance } = options;
  const title = `${printable(names.join(', '))}${distance === 1 ? '' : ` from ${distance} times the distance`}`;
  // Format everything before writing anything, so that an interrupted run leaves no partial file.
  const text = options.isJson
    ? accuracyJson(table, options, found)
    : `${accuracyText(table, title)}${cameraLine(found)}`;
  await writeFiles(
    outputs.map((output) => ({ ...output, content: accuracyChart(table, title) })),
    filesRead(),
  );
  report(text);
}

async function measure(
  options: AccuracyOptions,
  scenes: readonly SceneSource[],
  console: Console,
): Promise<{ readonly table: AccuracyTable; readonly found: FoundCamera | null }> {
  const { widthPx, heightPx, sortBy, detail, detailShares, distance, base, settings, frames } = options;
  const choice = await prepareCamera(options, widthPx / heightPx);
  const session = await openGpuSession(scenes, ACCURACY_PRESETS.reference);
  const { engine, notice, checkGpuErrors } = session;
  try {
    if (notice !== null) console.err(`note: ${notice}\n`);
    const clouds = session.clouds.map((cloud) => ({ cloud }));
    const { camera: near, found, notes } = await choice.choose((wishes) => frameScene(clouds, wishes));
    for (const note of notes) console.err(`note: ${note}\n`);
    const camera = distance === 1 ? near : cameraAtDistance(near, clouds, distance);
    const frame = { clouds, widthPx, heightPx, sortBy };
    const { drawn } = await findDetail(engine.createView(), { ...frame, camera, detail });
    const table = await measureAccuracy(engine, {
      ...frame,
      cameras: [camera],
      detail: drawn,
      details: detailShares.map((maxShare) => ({ maxShare })),
      base,
      settings,
      frames,
      onProgress: tenthsOf(console),
    });
    checkGpuErrors();
    return { table, found };
  } finally {
    engine.destroy();
  }
}
