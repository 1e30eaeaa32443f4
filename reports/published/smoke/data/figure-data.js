featherbench.chunk("figure-data",{});
