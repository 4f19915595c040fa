import { reference as motion } from '../../features/motion/motion.reference.ts';
import type { EffectPlace, EffectUse } from '../../gpu/effects/effect.ts';
import type { EffectReference } from './effect-reference.ts';

/** Makes the reference of an effect with these options, for a cloud at this place. */
export type ReferenceFunction = (options: never, place: EffectPlace) => EffectReference;

/** References of this package's effects, by path: each is beside its effect. */
const REFERENCES = import.meta.glob<ReferenceFunction>('../../gpu/effects/*/*.reference.ts', {
  eager: true,
  import: 'reference',
});

/**
 * Makes the references of `uses`, in their order.
 *
 * @param others references of effects from outside this package, by name.
 * @throws RangeError for an effect without a reference.
 */
export function referencesOf(
  uses: readonly EffectUse[],
  place: EffectPlace,
  others: Readonly<Record<string, ReferenceFunction>> = {},
): readonly EffectReference[] {
  return uses.map(({ effect: { name }, options }) => {
    const reference =
      REFERENCES[`../../gpu/effects/${name}/${name}.reference.ts`] ?? { motion, ...others }[name];
    if (!reference)
      throw new RangeError(`The effect ${name} has no reference: pass one in \`effectReferences\`.`);
    return reference(options as never, place);
  });
}
