import type { CloudFit } from '@websplatter/core';
import { formatBytes } from '@websplatter/kit/format';

const LIST = new Intl.ListFormat('en');

/** The notice that a scene has coarser settings than requested because GPU memory is too small. */
export function fitNotice(title: string, { wanted, taken, wantedBytes, takenBytes }: CloudFit): string {
  const changes = [
    taken.geometryPrecision !== wanted.geometryPrecision && `${taken.geometryPrecision} geometry`,
    taken.shPrecision !== wanted.shPrecision && `${taken.shPrecision} harmonics`,
    taken.shDegree !== wanted.shDegree &&
      `harmonics of degree ${taken.shDegree} instead of ${wanted.shDegree}`,
  ].filter((change) => change !== false);
  return `${title} needs ${formatBytes(wantedBytes)}, more than the GPU has left. It is shown with ${LIST.format(changes)}, in ${formatBytes(takenBytes)}.`;
}
