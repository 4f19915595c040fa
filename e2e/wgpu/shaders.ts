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
const byCode = new Map(variants.map((variant) => [linkShader(variant), variant]));
for (const [code, variant] of byCode) {
  device.pushErrorScope('validation');
  const module = device.createShaderModule({ label: variant.stage, code });
  const [{ messages }, error] = await Promise.all([module.getCompilationInfo(), device.popErrorScope()]);
  for (const { message } of error ? [error, ...messages] : messages)
    failures.push(`${describe(variant)}: ${message}`);
}

// Pipelines of render stages follow from their layers; hard cases make them.
const compute = variants.filter(({ entryPoint }) => entryPoint !== undefined);
const pipelines = new Pipelines(device);
for (const stage of compute) {
  await pipelines.prepare([stage]).catch((error) => failures.push(`${describe(stage)}: ${error}`));
}

const stageNames = [...new Set(variants.map(({ stage }) => stage))];
const compiled = { moduleCount: byCode.size, pipelineCount: compute.length, stageNames, leftOut, failures };
process.stdout.write(JSON.stringify(compiled satisfies CompiledShaders));
