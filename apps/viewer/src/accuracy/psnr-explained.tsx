/** Meaning of PSNR, for its first mention. */
export function PsnrExplained() {
  return (
    <details className="explained" data-testid="psnr-explained">
      <summary>What PSNR (dB) means</summary>
      <p>
        The peak signal-to-noise ratio says in decibels (dB) how close a picture is to the one that the preset
        reference draws; higher is closer. At 48 dB the colours are off by one step of 255 (root mean square),
        at 42 dB by two, at 28 dB by ten. “Identical” means that no pixel differs.
      </p>
    </details>
  );
}
