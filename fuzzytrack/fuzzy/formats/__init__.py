"""Rule bases in the formats of other programs: FIS of MATLAB and FLL of fuzzylite."""
