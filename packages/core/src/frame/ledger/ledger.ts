import { roundUp } from '../../data/layout/gpu-struct.ts';
import { EFFECT_LIST, isSameEffect, type ListedEffect, placeInList } from '../../gpu/effects/effect-list.ts';
import { changesOrder, parametersOf, STRUCT_ALIGNMENT } from '../../gpu/effects/effect-set.ts';
import type { AutomaticFeature, DrawnFrame, Reasons } from './automatic-features.ts';
import { AUTOMATIC_FEATURES } from './automatic-features.ts';

/** State of one effect in a frame. */
export interface EffectEntry {
  /** Lower case with hyphens. */
  readonly name: string;
  /** Name for people. */
  readonly label: string;
  /** The effect's purpose, in one sentence. */
  readonly about: string;
  /** Whether it is in the frame's shaders, buffers or passes; effects that are off cost nothing. */
  readonly isOn: boolean;
  /** Why it is on or off, for people. */
  readonly reason: string;
  /** Names of the clouds that it is on for; empty if it is off or belongs to the whole view. */
  readonly clouds: readonly string[];
  /** Stages that it may take part in; none if it is done on the CPU alone. */
  readonly stages: readonly string[];
  /** GPU memory held for it now, in bytes. Memory that effects share counts for each of them. */
  readonly bytes: number;
}

/** Lists automatic features, then effects in the order in which they act; both on and off. */
export function effectsLedger(frame: DrawnFrame): readonly EffectEntry[] {
  const { clouds } = frame.plan.request;
  const asked = clouds.flatMap(({ effects = [] }) => effects.map(({ effect }) => effect));
  const own = asked.filter((effect) => placeInList(effect) < 0);
  return [
    ...AUTOMATIC_FEATURES.map((feature) => featureEntry(feature, frame)),
    ...[...new Set(own), ...Object.values(EFFECT_LIST)].map((effect) => callersEntry(effect, frame)),
  ];
}

/** The reason for one cloud. */
interface Finding {
  readonly cloud: string;
  readonly reason: string;
}

function featureEntry(feature: AutomaticFeature, frame: DrawnFrame): EffectEntry {
  const { name, label, about, stages } = feature;
  const bytes = feature.bytes?.(frame) ?? 0;
  if (feature.of === 'view') {
    const isOn = feature.isOn(frame);
    return { name, label, about, isOn, reason: reasonOf(feature, isOn, frame), clouds: [], stages, bytes };
  }
  const { plan } = frame;
  const on: Finding[] = [];
  const off: Finding[] = [];
  for (const [index, cloudPlan] of plan.clouds.entries()) {
    const place = { plan, index, cloud: cloudPlan, shape: plan.shape.clouds[index] };
    const cloud = cloudPlan.instance.cloud.name;
    const isOn = feature.isOn(place);
    (isOn ? on : off).push({ cloud, reason: reasonOf(feature, isOn, place) });
  }
  const isOn = on.length > 0;
  const reason = together(isOn ? on : off);
  return { name, label, about, isOn, reason, clouds: namesOf(on), stages, bytes };
}

function reasonOf<Place>({ onReason, offReason }: Reasons<Place>, isOn: boolean, place: Place): string {
  const reason = isOn ? onReason : offReason;
  return typeof reason === 'string' ? reason : reason(place);
}

function callersEntry(effect: ListedEffect, { plan, held }: DrawnFrame): EffectEntry {
  const { name, label, about } = effect;
  const findings: Finding[] = [];
  let bytes = 0;
  for (const [index, { instance, uses }] of plan.clouds.entries()) {
    const planned = uses.find(({ use }) => isSameEffect(use.effect, effect));
    if (!planned) continue;
    // The selection may have changed since the last frame was drawn.
    const reason = planned.use.reason ?? 'it was needed when this frame was drawn';
    findings.push({ cloud: instance.cloud.name, reason });
    bytes += roundUp(parametersOf(planned.use)?.bytes ?? 0, STRUCT_ALIGNMENT);
    bytes += held.effects.bytesOf(planned.use.effect, index);
  }
  const isOn = findings.length > 0;
  return {
    name,
    label,
    about,
    isOn,
    reason: isOn ? together(findings) : reasonOff(effect, plan),
    clouds: namesOf(findings),
    stages: stagesOf(effect),
    bytes,
  };
}

function reasonOff(effect: ListedEffect, { clouds, request }: DrawnFrame['plan']): string {
  const left = clouds.flatMap(({ leftOut }) => leftOut).find((each) => isSameEffect(each.effect, effect));
  if (left) return `it is left out. ${left.error.message}`;
  const isAsked = request.clouds.some(
    ({ effects = [], opacity }) =>
      effects.some((use) => isSameEffect(use.effect, effect)) ||
      (effect.name === 'opacity' && opacity !== undefined),
  );
  return isAsked ? 'its options would change nothing' : 'no cloud asks for it';
}

function stagesOf({ hooks }: ListedEffect): readonly string[] {
  return changesOrder(hooks) ? ['cull-splats', 'project'] : ['project'];
}

/** Joins reasons: a single one as it stands, several with the names of their clouds. */
function together(findings: readonly Finding[]): string {
  const reasons = [...new Set(findings.map(({ reason }) => reason))];
  if (reasons.length === 0) return 'there is no cloud';
  if (reasons.length === 1) return reasons[0];
  return reasons
    .map((reason) => `${namesOf(findings.filter((each) => each.reason === reason)).join(', ')}: ${reason}`)
    .join('; ');
}

function namesOf(findings: readonly Finding[]): string[] {
  return [...new Set(findings.map(({ cloud }) => cloud))];
}
