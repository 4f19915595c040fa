import type { DrawnCloud, FeatureOfCloud } from '../automatic-feature.ts';

/** Colours that depend on the direction from which a splat is seen. */
export const harmonics: FeatureOfCloud = {
  of: 'cloud',
  name: 'harmonics',
  label: 'View-dependent colour',
  about: 'Evaluates spherical harmonics up to the highest visible degree.',
  stages: ['project'],
  calledFor: (cloud) =>
    cloud.shape.shDegree > 0
      ? `colours depend on the viewing direction: ${limitOf(cloud)}${isPalette(cloud) ? ', as a palette' : ''}`
      : null,
  offReason: limitOf,
  // Includes stored bands that are not evaluated.
  bytes: ({ plan }) => {
    const pages = new Set(plan.shape.clouds.flatMap(({ planes }) => planes.pages));
    return [...pages].reduce((sum, { shRest }) => sum + (shRest?.size ?? 0), 0);
  },
};

function isPalette({ shape }: DrawnCloud): boolean {
  return shape.planes.shPrecision === 'palette';
}

/** Says what limits the degree. */
function limitOf({ cloud: { instance }, shape }: DrawnCloud): string {
  const { declaredShDegree, trueShDegree } = instance.cloud.facts;
  const degree = shape.shDegree;
  if (degree < trueShDegree)
    return `it ${instance.shDegree === degree ? 'is asked for' : 'was loaded'} with degree ${degree} of the file’s ${declaredShDegree}`;
  return trueShDegree < declaredShDegree
    ? `of the file’s degree ${declaredShDegree} nothing above ${trueShDegree} could be seen`
    : `the file has degree ${declaredShDegree}`;
}
