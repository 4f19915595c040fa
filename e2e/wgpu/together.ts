// For Deno: compiles by naga the shaders of everything that may be in one frame.
import process from 'node:process';
import { requestSplatDevice } from '@websplatter/core';
import { linkShader } from '../../packages/core/src/gpu/shaders/link-shader.ts';
import { StagesTogether } from '../../packages/core/src/testing/stages-together.ts';

/** Results of the compilation. */
export interface CompiledTogether {
  readonly frameCount: number;
  readonly moduleCount: number;
  readonly failures: readonly string[];
}

const device = await requestSplatDevice();
const failures: string[] = [];
device.addEventListener('uncapturederror', ({ error }) => failures.push(error.message));

const together = new StagesTogether(device);
const codes = new Set<string>();
let frameCount = 0;
for (const some of [...together.pairs(), ...together.triples()]) {
  const stages = await together.newStagesOf(some);
  if (stages) frameCount++;
  for (const stage of stages ?? []) {
    const code = linkShader(stage);
    if (codes.has(code)) continue;
    codes.add(code);
    device.pushErrorScope('validation');
    const module = device.createShaderModule({ label: stage.stage, code });
    const [{ messages }, error] = await Promise.all([module.getCompilationInfo(), device.popErrorScope()]);
    const names = some.map(({ name }) => name).join(' + ');
    for (const { message } of error ? [error, ...messages] : messages)
      failures.push(`${names}, ${stage.stage}: ${message}`);
  }
}
const compiled = { frameCount, moduleCount: codes.size, failures };
process.stdout.write(JSON.stringify(compiled satisfies CompiledTogether), () => process.exit());
