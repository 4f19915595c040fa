// For Deno: compiles every variant of every stage by naga, and makes pipelines of compute stages.
import process from 'node:process';
import { requestSplatDevice } from '@websplatter/core';
import { Pipelines, type StageDefinition } from '../../packages/core/src/gpu/pipelines.ts';
import { linkShader } from '../../packages/core/src/gpu/shaders/link-shader.ts';
import { allStageVariants } from '../../packages/core/src/testing/stage-variants.ts';

/** Results of the shaders' compilation. */
export interface CompiledShaders {
  readonly stageNames: readonly string[];
  readonly moduleCount: number;
  readonly pipelineCount: number;
  /** Features that the device lacks, by the number of variants that need them and were left out. */
  readonly leftOut: Readonly<Record<string, number>>;
  readonly failures: readonly string[];
}

const device = await requestSplatDevice();
const failures: string[] = [];
const leftOut: Record<string, number> = {};
device.addEventListener('uncapturederror', ({ error }) => failures.push(error.message));

function describe({ stage, entryPoint, conditions }: StageDefinition): string {
  return `${stage} ${entryPoint ?? ''} ${JSON.stringify(conditions)}`;
}

const variants = (await allStageVariants()).filter(({ conditions }) => {
  if (!conditions?.SUBGROUPS || device.features.has('subgroups')) return true;
  leftOut.subgroups = (leftOut.subgroups ?? 0) + 1;
  return false;
});
/** Messages about each module that is made, by its text. */
const messagesOf = new Map<string, Promise<void>>();
const { createShaderModule } = device;
device.createShaderModule = (descriptor) => {
  const module = createShaderModule.call(device, descriptor);
  const reading = module.getCompilationInfo().then(({ messages }) => {
    for (const { message } of messages) failures.push(`${descriptor.label}: ${message}`);
  });
  messagesOf.set(descriptor.code, reading);
  return module;
};

// Pipelines of render stages follow from their layers; hard cases make them.
const compute = variants.filter(({ entryPoint }) => entryPoint !== undefined);
const pipelines = new Pipelines(device);
for (const stage of compute) {
  await pipelines.prepare([stage]).catch((error) => failures.push(`${describe(stage)}: ${error}`));
}
const render = variants.filter(({ entryPoint }) => entryPoint === undefined);
const byCode = new Map(render.map((variant) => [linkShader(variant), variant]));
for (const [code, variant] of byCode) {
  if (messagesOf.has(code)) continue;
  device.pushErrorScope('validation');
  device.createShaderModule({ label: variant.stage, code });
  const error = await device.popErrorScope();
  if (error) failures.push(`${describe(variant)}: ${error.message}`);
}
await Promise.all(messagesOf.values());

const stageNames = [...new Set(variants.map(({ stage }) => stage))];
const compiled = {
  moduleCount: messagesOf.size,
  pipelineCount: compute.length,
  stageNames,
  leftOut,
  failures,
};
process.stdout.write(JSON.stringify(compiled satisfies CompiledShaders));
