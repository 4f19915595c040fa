import type { PresetCost } from './verdict.ts';

/** Costs of the built-in scene that docs/accuracy.md tells of, to show before any are measured here. */
export const RECORDED: {
  readonly title: string;
  readonly about: string;
  readonly costs: readonly PresetCost[];
} = {
  title: 'Still life',
  about: 'Recorded on an NVIDIA H200 at 1920 × 1080, not on this device.',
  costs: [
    recorded('reference', 0.47, 0),
    recorded('high', 0.45, 1),
    recorded('balanced', 0.44, 1),
    recorded('fast', 0.39, 103),
    recorded('paper', 12.43, 31),
  ],
};

function recorded(name: string, ms: number, maxSteps: number): PresetCost {
  return { name, totalMs: { median: ms, low: ms, high: ms }, stagesMs: null, maxSteps };
}
