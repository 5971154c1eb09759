"""From regions to tissue: diffusivity tensor, excitable mask, stimuli."""
